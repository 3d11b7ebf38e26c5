"""Thirty logs in the layouts of drives, robots and tools, each in ten variants, and what is true of them.

A layout is a header as its maker writes it (`source` says where that is to be seen), a way to write it, and the truth: which
column is which channel, and what one of its units is in SI. The motion is made in closed form and shares nothing with the
workbench.
"""

from logs.layouts import LAYOUTS
from logs.signals import VARIANTS, Column, Layout, Made, made

__all__ = ["LAYOUTS", "VARIANTS", "Column", "Layout", "Made", "made"]
