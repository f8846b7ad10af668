"""Derivatives of recorded motions between walls of all kinds against differences of the exact motion in 60 digits."""

import itertools

import mpmath
import numpy as np
import pytest
from helpers.logs import log_of, raised

import idealgas
from idealgas import open_log, open_run, parse_scene
from idealgas.columns import SIDES, Kind

pytestmark = pytest.mark.usefixtures("uncompiled")

STEP = mpmath.mpf(10) ** -20

BOX = "box.size = [6, 5]\nrun.events = 16\n"
JOINED = BOX.replace("16", "11") + 'box.left = "periodic"\nbox.right = "periodic"\n'
DISCS = """
disc = [
    { position = [2.2, 2.3], velocity = [0.9, 0.37], radius = 0.2, mass = 1.5 },
    { position = [3.4, 2.9], velocity = [-0.55, -0.61], radius = 0.3 },
PEG]
"""
PEG = "{ position = [5.9, 2.4], radius = 0.35, fixed = true },"
BARE, PEGGED = DISCS.replace("PEG", ""), DISCS.replace("PEG", PEG)
CIRCLE = "wall = [{ from = [0.5, 2.5], to = [0.5, 2.5], via = [5.5, 2.5] }]\n"
SLANT = "wall = [{ from = [1.5, 1], to = [2.1, 1.4] }, { from = [4.5, 2.4], to = [4.1, 3.1] }]\n"
BOW = """
wall = [
    { from = [1.2, 1], to = [2.1, 1.4], via = [1.7, 1.5] },
    { from = [4.5, 2], to = [4.3, 3], via = [4.6, 2.5] },
]
"""
ONE_WAY = "wall = [{ from = [3, 1], to = [3.1, 4.2], permeable_from = 'left' }]\n"
GRAVITY = "gravity.acceleration = [0.11, -0.3]\n"
DOWN = "gravity.acceleration = [0, -0.3]\n"
STEPS = "gravity.acceleration = [[0, [0.11, -0.3]], [3.3, [-0.2, 0.1]]]\n"
INELASTIC = "restitution = { normal = 0.8, wall = 0.9, contact_duration = 1e-6 }\n"
DRIVEN = "run.until = 12\npiston = [{ position = 5.5, velocity = -0.07 }]\n"
PRESSED = "piston = [{ inner = 'x', position = 2.75, mass = 0.7 }, { position = 5.2, mass = 3, pressure = 0.05 }]\n"

SHAKEN = "box.bottom = { vibrating = { amplitude = 0.2, frequency = 0.3 } }\n"
SINE = SHAKEN.replace("0.3", "0.3, motion = 'sine'").replace("bottom", "right")

MOTIONS = {
    "sides": (BOX + BARE + GRAVITY, {Kind.DISC, Kind.WALL}),
    "slant": (JOINED + SLANT + BARE, {Kind.DISC, Kind.WALL}),
    "slant, gravity": (BOX + SLANT + BARE + STEPS + INELASTIC, {Kind.DISC, Kind.WALL, Kind.WALL_END, Kind.STEERED}),
    "circle": (BOX + CIRCLE + BARE + GRAVITY, {Kind.DISC, Kind.WALL}),
    "arc": (JOINED + BOW + BARE, {Kind.DISC, Kind.WALL, Kind.WALL_END}),
    "arc, gravity": (BOX + BOW + BARE + GRAVITY + INELASTIC, {Kind.DISC, Kind.WALL, Kind.WALL_END}),
    "fixed disc": (JOINED + PEGGED, {Kind.DISC, Kind.WALL, Kind.FIXED_DISC}),
    "fixed disc, gravity": (JOINED + PEGGED + DOWN + INELASTIC, {Kind.DISC, Kind.WALL, Kind.FIXED_DISC}),
    "driven piston": (BOX + BARE + DRIVEN + INELASTIC, {Kind.DISC, Kind.WALL, Kind.PISTON}),
    "parabolas": (BOX + SHAKEN + BARE + GRAVITY + INELASTIC, {Kind.DISC, Kind.WALL}),
    "sine": (BOX + SINE + BARE + GRAVITY, {Kind.DISC, Kind.WALL}),
    "one-way": (BOX + ONE_WAY + BARE, {Kind.DISC, Kind.WALL}),
    "pistons": (BOX + BARE + PRESSED + INELASTIC, {Kind.WALL, Kind.PISTON}),
}
"""Scenes, and the kinds of events in their logs."""


def vector(*components):
    return np.array([mpmath.mpf(each) for each in components])


class Body:
    """A disc or a piston in free flight: its state at a time, mass, and steps (time, acceleration)."""

    def __init__(self, place, velocity, mass, steps):
        self.time, self.place, self.velocity, self.mass, self.steps = mpmath.mpf(0), place, velocity, mass, steps

    def at(self, time):
        """Position and velocity at another time."""
        place, velocity, now = self.place, self.velocity, self.time
        for (begin, pull), (until, _) in itertools.pairwise([*self.steps, (mpmath.inf, None)]):
            if now < until and time > begin:
                dt = min(time, until) - now
                place, velocity, now = place + velocity * dt + pull * dt**2 / 2, velocity + pull * dt, now + dt
        return place, velocity


class Shaken(Body):
    """A vibrating side, without its velocity, which is that of its normal displacement."""

    def __init__(self, wall, table):
        super().__init__(None, None, mpmath.inf, [])
        self.inward = (1 - 2 * (wall % 2)) * vector(wall < 2, wall >= 2)
        self.table = table

    def at(self, time):
        """Position relative to the lowest point and velocity at a time."""
        amplitude, phase = mpmath.mpf(self.table.amplitude), time * mpmath.mpf(self.table.frequency)
        rate = mpmath.mpf(self.table.frequency)
        if self.table.motion == "sine":
            angle = 2 * mpmath.pi * phase
            height, speed = amplitude * (1 - mpmath.cos(angle)), 2 * mpmath.pi * rate * amplitude * mpmath.sin(angle)
        else:
            lowest, highest = phase - mpmath.nint(phase), phase - mpmath.floor(phase) - mpmath.mpf(0.5)
            if abs(lowest) < 0.25:
                height, speed = 16 * amplitude * lowest**2, 32 * amplitude * lowest * rate
            else:
                height, speed = 2 * amplitude - 16 * amplitude * highest**2, -32 * amplitude * highest * rate
        return height * self.inward, speed * self.inward


class Motion:
    """Exact motion through the recorded sequence of collisions, from any start near the recorded one."""

    def __init__(self, log):
        self.log, self.scene = log, log.scene
        (self.rows,) = log.chunks()
        self.surfaces = {}
        self.walls = [*SIDES, *self.scene.walls]

    def bodies(self, state):
        gravity = self.scene.gravity.steps if self.scene.gravity else [(0.0, (0.0, 0.0))]
        steps = [(mpmath.mpf(time), vector(*pull)) for time, pull in gravity]
        bodies = [
            Body(state[4 * k : 4 * k + 2], state[4 * k + 2 : 4 * k + 4], mpmath.mpf(mass), steps)
            for k, mass in enumerate(self.log.discs.mass)
        ]
        for piston in self.scene.piston:
            axis = vector(*(along == piston.axis for along in range(2)))
            start, velocity = axis * piston.start(self.log.box), axis * piston.start_velocity
            pull = -axis * piston.outward * mpmath.mpf(piston.pressure or 0) * self.log.box[1 - piston.axis]
            mass = mpmath.mpf(piston.mass) if piston.mass else mpmath.inf
            bodies.append(Body(start, velocity, mass, [(0, pull / mass)]))
        sides = [getattr(side, "vibrating", None) for side in self.scene.box.sides]
        return [
            *bodies,
            *(
                Shaken(k, side) if side else Body(vector(0, 0), vector(0, 0), mpmath.inf, [(0, vector(0, 0))])
                for k, side in enumerate(sides)
            ),
        ]

    def candidates(self, row):
        """Other body, and the surfaces (point, normal; or centre, distance) that disc i may touch in an event."""
        kind, partner = self.rows.kind[row], self.rows.partner[row]
        r = mpmath.mpf(float(self.log.discs.radius[self.rows.disc[row]]))
        if kind == Kind.DISC:
            return partner, self.images((0, 0), [r + mpmath.mpf(float(self.log.discs.radius[partner]))])
        wall = self.walls[-1 - partner]
        name = wall if isinstance(wall, str) else wall.name
        if kind == Kind.PISTON:
            k = [piston.wall for piston in self.scene.piston].index(name)
            normal = vector(*(along == self.scene.piston[k].axis for along in range(2)))
            return len(self.log.discs) + k, [(sign * r * normal, normal, None) for sign in (-1, 1)]
        if wall in SIDES:
            k = SIDES.index(wall)
            normal = vector(k < 2, k >= 2)
            return k - len(SIDES), [((mpmath.mpf(self.log.box[k // 2]) - r if k % 2 else r) * normal, normal, None)]
        if kind == Kind.WALL_END:
            return None, [surface for end in (wall.start, wall.end) for surface in self.images(end, [r])]
        if kind == Kind.FIXED_DISC:
            return None, self.images(wall.start, [r + mpmath.mpf(wall.radius)])
        if wall.arc:
            x, y, radius = (mpmath.mpf(each) for each in wall.arc[:3])
            centre = mpmath.mpf(wall.start[0]) + x, mpmath.mpf(wall.start[1]) + y
            return None, self.images(centre, [radius - r, radius + r])
        along = vector(*wall.end) - vector(*wall.start)
        normal = np.array([-along[1], along[0]]) / mpmath.hypot(*along)
        return None, [
            (vector(*wall.start) + sign * r * normal + shift, normal, None)
            for sign in (-1, 0, 1)  # a one-way wall reflects discs that overlap with it at their centres
            for shift in self.shifts()
        ]

    def shifts(self):
        spans = [range(-4, 5) if on else (0,) for on in self.log.periodic]
        return [vector(x, y) * vector(*self.log.box) for x, y in itertools.product(*spans)]

    def images(self, centre, distances):
        return [(vector(*centre) + shift, None, distance) for distance in distances for shift in self.shifts()]

    @staticmethod
    def gap(surface, apart):
        point, normal, distance = surface
        away = apart - point
        return away @ normal if normal is not None else mpmath.hypot(*away) - distance

    def contact(self, surface, i, j, time):
        """Time of a contact by Newton's method, and the normal."""
        for _ in range(9):
            (pi, vi), (pj, vj) = i.at(time), j.at(time)
            away = pi - pj - surface[0]
            normal = surface[1] if surface[1] is not None else away / mpmath.hypot(*away)
            time -= self.gap(surface, pi - pj) / ((vi - vj) @ normal)
        assert abs(self.gap(surface, pi - pj)) < 1e-50
        return time, normal

    def __call__(self, state):
        """The state of the discs (4 N,) at the end of the log."""
        bodies, rest = self.bodies(state), Body(vector(0, 0), vector(0, 0), mpmath.inf, [(0, vector(0, 0))])
        restitution = self.scene.restitution
        row = 0
        while row < len(self.rows.time):
            kind, logged = self.rows.kind[row], mpmath.mpf(float(self.rows.time[row]))
            if kind == Kind.STEERED:
                row += 1
                continue
            other, surfaces = self.candidates(row) if row not in self.surfaces else self.surfaces[row]
            i, j = bodies[self.rows.disc[row]], rest if other is None else bodies[other]
            nearest = min(surfaces, key=lambda each: abs(self.gap(each, i.at(logged)[0] - j.at(logged)[0])))
            assert abs(self.gap(nearest, i.at(logged)[0] - j.at(logged)[0])) < 1e-6
            self.surfaces[row] = other, [nearest]
            time, normal = self.contact(nearest, i, j, logged)
            (pi, vi), (pj, vj) = i.at(time), j.at(time)
            e = 1 if restitution is None else restitution.normal if kind == Kind.DISC else restitution.wall
            ratio = i.mass / j.mass if j.mass != mpmath.inf else mpmath.mpf(0)
            impulse = (1 + mpmath.mpf(e)) / (1 + ratio) * ((vi - vj) @ normal) * normal
            i.time, i.place, i.velocity = time, pi, vi - impulse
            if other is not None:
                j.time, j.place, j.velocity = time, pj, vj + ratio * impulse
            row += 1 + (kind == Kind.DISC)
        end = mpmath.mpf(self.log.end_time)
        return np.concatenate([part for body in bodies[: len(self.log.discs)] for part in body.at(end)])


@pytest.mark.parametrize("name", MOTIONS)
def test_derivatives(name):
    """The rounding of a run, 1e-14, grows along with the deviations and shifts derivatives of second order."""
    text, kinds = MOTIONS[name]
    log = log_of(text)
    motion = Motion(log)
    with mpmath.workdps(60):
        state = [mpmath.mpf(float(each)) for each in np.hstack([log.discs.position, log.discs.velocity]).ravel()]
        motion(np.array(state))
        columns = []
        for k in range(len(state)):
            ends = []
            for sign in (1, -1):
                moved = np.array(state)
                moved[k] += sign * STEP
                ends.append(motion(moved))
            columns.append([float(each) for each in (ends[0] - ends[1]) / (2 * STEP)])
    expected = np.array(columns).T
    result = idealgas.sensitivity(log).reshape(len(state), len(state))
    growth = np.abs(expected).max()
    assert set(motion.rows.kind) == kinds
    assert growth < 1e8
    assert np.abs(result - expected).max() < 1e-14 * growth**2


UNKNOWN = {
    "discs leave the gas": BOX + BARE + "run.until = 2\nwall = [{ from = [4, 3], to = [4, 4], absorbing = true }]\n",
    "sides are sheared": JOINED + BARE + "box.bottom = { shear = 0.1 }\nbox.top = { shear = 0.1 }\n",
    "a piston hits a side before t = ": BOX + BARE + "piston = [{ position = 5.5, mass = 3, pressure = 0.02 }]\n",
    r"disc \d touches another body at t = .* at speed 0": BOX + BARE + GRAVITY + "restitution.wall = 0\n",
}
"""Scenes, and why their logs have no tangent map."""


@pytest.mark.parametrize("reason", UNKNOWN)
def test_refused(reason):
    raised(f"the tangent map is not available, because {reason}", idealgas.sensitivity, log_of(UNKNOWN[reason]))


def test_a_program_that_changes_velocities_is_refused(tmp_path):
    """A reversal does; a change of gravity, which is also recorded for each disc, does not (see the scenes above)."""
    path = tmp_path / "run.h5"
    with open_run(parse_scene(f"steering = {{}}\n{BOX}{BARE}"), path) as run:
        run.advance(until=2)
        run.reverse()
        run.advance(until=4)
    raised("because a program changes velocities at t = 2", idealgas.sensitivity, open_log(path))


HIT = "box.size = [8, 6]\nrun.until = 1\n"
CHANGED = "gravity.acceleration = [[0, [0, 0]], [0.48, [0, -0.1]]]\n"


@pytest.mark.parametrize(
    ("place", "velocity", "duration", "start", "more", "factors"),
    [
        ([0.51, 3], [-1, 0], 1e-9, 0.0, "", (-0.5, 1)),
        ([0.51, 3], [-1, 0], 0.05, 0.0, "", (-0.5, 1)),
        ([1.01, 3], [-1, 0], 0.05, 0.47, "", (-0.5, 1)),
        ([1.01, 3], [-1, 0], 0.05, 0.2, "", (-0.5, 1)),
        ([1.01, 3], [-1, 0], 0.05, 0.2, CHANGED, (-0.5, 1)),
        ([1.03, 1.01], [-1, -1], 0.05, 0.52, "", (-1, 1)),
        ([1.03, 1.01], [-1, -1], 0.05, 0.2, "", (-1, -0.5)),
        ([1.03, 1.01], [-1, -1], 0.01, 0.52, "", (-0.5, 1)),
    ],
)
def test_contact_duration_counts_from_collisions(place, velocity, duration, start, more, factors):
    """A hit is elastic only soon after a collision, which may precede the window, not after its start or a new g."""
    restitution = f"restitution = {{ normal = 1, wall = 0.5, contact_duration = {duration} }}\n"
    log = log_of(f"{HIT}{more}{restitution}disc = [{{ position = {place}, velocity = {velocity}, radius = 0.5 }}]\n")
    assert log.state_at(1.0).velocity[0, 0] == factors[0] * velocity[0]
    assert np.diag(idealgas.sensitivity(log, start, 1.0)[0, :, 0]) == pytest.approx([*factors, *factors], abs=1e-14)
