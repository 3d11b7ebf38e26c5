"""The catalogue: one physical effect each, registered by `workbench.definition.effect`, whose `find` and `catalogue` hand them on."""
