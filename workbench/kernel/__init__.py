"""From a symbolic step to machine speed: CasADi graph -> scalar instructions -> NumPy or one numba kernel, same bits."""
