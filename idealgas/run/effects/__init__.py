"""A scene's effects in a run: one file per effect, each with its arrays, what the log keeps of it, and its energy."""

from idealgas.run.effects.bundle import make_effects

__all__ = ["make_effects"]
