"""What `import workbench` hands on: the direct entries that an engineer with a notebook calls.

    folder ─► load ─► Campaign ─┬► check ─► findings            identify ─► Fit        trace ─► Trace
    Plant + records, bandwidth ─┘  diff, plan, separate, response
    Plant, Fit or Trace ─► describe ─► Equivalent   tune ─► Gains ─► fit_schedule ─► Schedule ─► simulate, compensate, export

Wherever a plant is asked for, a Fit or a Trace may stand for the plant that it ends with, and a folder for its campaign.
Here are no results of its own: each function puts its arguments in the form that a package has, and calls it.
"""
