"""Where a residual lives: windows of position, speed and time, moments at which it changes, maps, spectra, and its noise floor."""

from workbench.public import handed_on

HELD = {
    "Map": "maps",
    "Residual": "residual_maps",
    "ResidualMaps": "residual_maps",
    "Spectrum": "spectra",
    "Window": "window",
    "localise": "localisation",
    "map_residual": "residual_maps",
    "noise_rms": "noise_floor",
}

__all__ = [*HELD]
__getattr__, __dir__ = handed_on(__name__, HELD)
