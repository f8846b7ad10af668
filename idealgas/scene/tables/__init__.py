"""The tables of a scene: box, discs, run and log; those of the effects are in `idealgas.effects`."""
