"""The campaign.toml of one mass with two records, as tests of the checks write it."""


def declared(title: str, bandwidth: float, resolution: float, further: str = "") -> str:
    """Return the text. bandwidth: Hz. resolution: rad, of the encoder. further: effects beside inertia and viscous friction."""
    return f"""title = "{title}"
plant = "one mass"
evaluation_bandwidth = {{ value = {bandwidth}, unit = "Hz" }}
[channels]
time = {{ column = "t", unit = "s" }}
torque = {{ column = "u", unit = "N*m" }}
position = {{ column = "q", unit = "rad", resolution = {resolution} }}
[[effects]]
effect = "inertia"
at = "axis"
[[effects]]
effect = "viscous_friction"
at = "axis"
{further}[[records]]
file = "a.csv"
role = "identification"
[[records]]
file = "b.csv"
role = "validation"
"""
