"""Optimisation-driven controller design workbench: from measured records of a servo axis to the gains its firmware runs."""

__version__ = "0.1.0"
