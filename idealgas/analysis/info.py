"""Describe the contents of a log, without reading its events: file, scene, discs and run."""

import os
from typing import Any

import numpy as np

from idealgas.analysis.registry import shown
from idealgas.log import Log
from idealgas.theory.conserved import centre_of_mass_energy, centre_of_mass_velocity
from idealgas.theory.ensemble import composition


def info(log: Log) -> dict[str, Any]:
    """Describe the file, the scene, the discs and the run of a log as nested plain values, ready for JSON."""
    gas, discs, frame = log.discs, composition(log.discs), centre_of_mass_velocity(log.scene, log.discs)
    frame = np.where(np.abs(frame) > 1e-12 * np.abs(gas.velocity).max(), frame, 0.0)  # remove rounding errors
    left, bottom, right, top = log.scene.room
    species = zip(discs.name, discs.number.tolist(), discs.radius.tolist(), discs.mass.tolist(), strict=True)
    return {
        "file": {
            "path": str(log.path),
            "bytes": os.path.getsize(log.path),
            **{name: value for name, value in log.attributes.items() if name != "seed"},
            "command": log.command,
            "state": log.run_state,
        },
        "scene": {
            "title": log.scene.scene.title,
            "shows": list(shown(log.scene)),
            "seed": log.scene.scene.seed,
            "method": log.scene.run.method,
        },
        "gas": {
            "box": list(log.box),
            "number": len(gas),
            "packing_fraction": gas.packing_fraction * gas.area / ((right - left) * (top - bottom) - gas.solid_area),
            "kinetic_energy": gas.kinetic_energy,
            "common_motion": frame.tolist(),
            "temperature": (gas.kinetic_energy - centre_of_mass_energy(log.scene, log.discs)) / len(gas),
            "species": [
                {"name": name, "number": number, "radius": radius, "mass": mass}
                for name, number, radius, mass in species
            ],
        },
        "run": {
            "start_time": log.start_time,
            "end_time": log.end_time,
            "event_rows": len(log) if log.has_events else None,
            "event_columns": list(log.columns) if log.has_events else [],
            "walls": [wall.name for wall in log.walls],
            "checkpoints": len(log.checkpoints),
            "observables": sorted(log.observables),
            "summary": log.summary,
            **_reference_speed(log),
        },
    }


def _reference_speed(log: Log) -> dict[str, Any]:
    """Return the reference speed at the start and at the end, length/time, and how many times it was raised.

    The result is empty if the log does not record the reference speed.
    """
    if "v_ref" not in log.observables:
        return {}
    values = log.observables["v_ref"][1]
    raises = int((values[1:] != values[:-1]).sum())
    return {"v_ref": {"start": float(values[0]), "end": float(values[-1]), "raises": raises}}
