"""Page that shows a log in the browser, even during the run, and a server that accepts only local connections."""

import json
import math
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from http.server import BaseHTTPRequestHandler
from pathlib import Path
from socket import SHUT_RDWR
from socketserver import ThreadingTCPServer
from string import Template
from threading import Lock, Timer
from typing import Any
from urllib.parse import parse_qsl, urlsplit

import numpy as np

from idealgas.analysis.evolution.theory import expected_law
from idealgas.analysis.pressure.measure import pressure
from idealgas.analysis.pressure.routes import PAIRS
from idealgas.errors import UserError
from idealgas.examples import first_sentence
from idealgas.log import DamageError, Log
from idealgas.presentation.style import BLACK, COLOURS, curve_style, panels
from idealgas.presentation.tables import escape
from idealgas.report.page import SCRIPTS, description_html, player_html, text_of
from idealgas.report.picture import html_pictures
from idealgas.report.player import MOST_DISCS, crossing, player
from idealgas.statistics.estimates import Estimate
from idealgas.theory.conserved import centre_of_mass_velocity

HOST = "127.0.0.1"

ROWS = 2**16
"""Largest number of event rows in a segment of the motion."""

SECONDS = 2.0
"""Playing time of the newest segment of a run, s."""

POINTS = 128
"""Smallest number of points in the curves for a long log."""

POINT_ROWS = 2**14
"""Number of event rows around a point over which the pressure is averaged."""

PATIENCE = 10.0
"""Time limit for each pause of a connection, for receiving its request, and for sending the answer, s."""

MEASURING = 0.2
"""Time that may be spent on measuring new points for one answer, s."""


class Live:
    """Segments of the motion, and curves of temperature and pressure, from a log that a run may still be writing."""

    def __init__(self, log: Log) -> None:
        """Prepare the log.

        Raises:
            UserError: if the log has no events or too many discs.
        """
        log.require_events()
        if len(log.discs) > MOST_DISCS:
            raise UserError(f"{log.path}: has {len(log.discs):,} discs (allowed up to {MOST_DISCS:,} to be shown)")
        self._log, self._lock, self._second = log, Lock(), crossing(log.box, log.discs.velocity)
        self._points: dict[float, tuple[float, dict[str, Estimate]]] = {}  # temperature and pressures, by time

    @property
    def running(self) -> bool:
        """Whether a run is still writing the log."""
        return self._log.live

    def page(self) -> str:
        """Return the HTML of the page, which then requests all data that may change."""
        log, scene = self._log, self._log.scene.scene
        heading = "The discs" if log.has_positions else "The speeds"
        shown = "Each part of the motion is followed by the newest part, or by the next part if the box is unticked."
        lead, description = first_sentence(scene.description)
        return Template(text_of("watch.html")).substitute(
            title=escape(scene.title or Path(log.path).name),
            lead=escape(lead),
            style=text_of("report.css"),
            script="\n".join(map(text_of, (*SCRIPTS, "live.js"))),
            description=description_html(description),
            state=log.run_state,
            newest="" if log.complete else " checked",
            player=player_html(log, heading, shown),
            footer=escape(str(log.path)),
        )

    def part(self, after: float, newest: bool) -> dict[str, Any]:
        """Return a segment of the motion as plain values for JSON.

        Args:
            after: time at which the segment begins.
            newest: whether the segment may begin later, to show the newest SECONDS of the run.
        """
        with self._refreshed() as log:
            first = max(after, self._newest()) if newest else after
            motion = None
            if first < log.end_time and (played := player(log, first, ROWS, order=False)):
                self._second = played.head["speed"]
                if newest:
                    played.head["speed"] = min(self._second, (played.end - played.start) / SECONDS)
                motion = {"head": played.head, "arrays": played.arrays}
            return {"running": self.running, "motion": motion}

    def curves(self, points: int) -> dict[str, Any]:
        """Measure more points, and return the curves and the state of the run as plain values for JSON.

        Args:
            points: number of points that the page already shows; if there are no new points, the curves are omitted.
        """
        with self._refreshed() as log:
            self._measure()
            return {
                "running": self.running,
                "state": f"{log.run_state}: {len(log):,} event rows up to t = {log.end_time:.6g}",
                "points": len(self._points),
                "html": self._curves() if len(self._points) > points else None,
            }

    @contextmanager
    def _refreshed(self) -> Iterator[Log]:
        """Yield the log in its current state, to one request at a time."""
        with self._lock:
            if not self._log.complete:
                self._log.refresh()
            yield self._log

    def _newest(self) -> float:
        """Return the start of the newest segment of the motion."""
        log = self._log
        row = max(len(log) - ROWS, 0)
        return max(self._time_of(row) if row else log.start_time, log.end_time - SECONDS * self._second)

    def _time_of(self, row: int) -> float:
        (block,) = self._log.chunks(("time",), row, row + 1)
        return float(block.time[0])

    def _measure(self) -> None:
        """Measure points at the centres of the longest intervals between points, for MEASURING seconds."""
        log, done = self._log, time.monotonic() + MEASURING
        while log.end_time > log.start_time and time.monotonic() < done:
            edges = np.array([log.start_time, *sorted(self._points), log.end_time])
            k = int(np.diff(edges).argmax())
            if edges[k + 1] - edges[k] < (log.end_time - log.start_time) / POINTS:
                break
            middle = float(edges[k] + edges[k + 1]) / 2
            self._points[middle] = _temperature(log, middle), self._pressures(middle)

    def _pressures(self, middle: float) -> dict[str, Estimate]:
        """Return the pressure near a time, by name: of the gas or, without an equation of state, on each wall."""
        log = self._log
        row = min(max(log.row_at(middle) - POINT_ROWS // 2, 0), max(len(log) - 1 - POINT_ROWS, 0))
        try:
            result = pressure(log, self._time_of(row), self._time_of(min(row + POINT_ROWS, len(log) - 1)))
        except DamageError:
            raise
        except UserError:
            return {}
        if result.mechanical:
            return {f"on {wall.name}": wall.pressure for wall in result.mechanical.walls}
        pairs = next((route.pressure for route in result.routes if route.name == PAIRS), None)
        return {} if pairs is None else {"of the gas": pairs}

    def _curves(self) -> str:
        """Return figures of temperature and pressure against time, as HTML."""
        times = np.array(sorted(self._points))
        temperatures, pressures = zip(*(self._points[t] for t in times), strict=True)
        names = list(dict.fromkeys(name for estimates in pressures for name in estimates))
        figure, axes = panels(2 if names else 1)
        axes[0].plot(times, temperatures, "o", ms=3, color=COLOURS[0], label="kinetic energy per disc")
        if law := expected_law(self._log, times):
            axes[0].plot(times, law.temperature, "--", color=BLACK, label=law.text)
        low, high = min(temperatures), max(temperatures)
        if high - low < 1e-6 * high:  # the temperature changes only by rounding
            axes[0].set_ylim(0.9 * low, 1.1 * high)
        axes[0].set_ylabel("temperature (energy, k_B = 1)")
        for k, name in enumerate(names):
            colour, _, marker = curve_style(k)
            points = [(t, estimates[name]) for t, estimates in zip(times, pressures, strict=True) if name in estimates]
            at, values = zip(*points, strict=True)
            axes[1].errorbar(
                at, [estimate.value for estimate in values], [estimate.standard_error for estimate in values],
                fmt=marker, ms=3, elinewidth=0.8, color=colour, label=f"P {name}",
            )  # fmt: skip
            if values[0].theory is not None:
                axes[1].plot(at, [estimate.theory for estimate in values], "--", color=BLACK, label="theory")
            axes[1].set_ylabel("pressure (energy/length²)")
        for ax in axes:
            ax.time_axis()
            ax.legend()
        caption = f"Temperature at, and pressure around, {len(times)} times of the run; click to show the discs"
        return html_pictures(figure, caption, "live")


def _temperature(log: Log, at: float) -> float:
    """Return the kinetic energy per disc at a time, excluding a conserved motion of the gas as a whole."""
    state = log.state_at(at)
    velocity = state.velocity - centre_of_mass_velocity(log.scene, log.discs)
    return state.mean(log.discs.mass * (velocity**2).sum(axis=1)) / 2


# ── the server ──


class _Server(ThreadingTCPServer):
    """Server for the page of a log."""

    allow_reuse_address = True
    daemon_threads = True
    request_queue_size = 128

    def __init__(self, live: Live, port: int) -> None:
        self.live = live
        super().__init__((HOST, port), _Handler)
        self.name = f"{HOST}:{self.server_address[1]}"

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Print only errors in the program, because browsers may end a connection at any time."""
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(request, client_address)


class _Handler(BaseHTTPRequestHandler):
    """Handler of browser requests for the page, segments of the motion, and curves."""

    server: _Server
    server_version, sys_version = "idealgas", ""
    timeout = PATIENCE  # limit of each wait for bytes, and for sending an answer

    def setup(self) -> None:
        """Begin a connection; it is closed if its request is not complete in time, even while bytes still arrive."""
        super().setup()
        self._timer = Timer(self.timeout, self._hang_up)
        self._timer.daemon = True
        self._timer.start()

    def parse_request(self) -> bool:
        """Read the rest of a request."""
        complete = super().parse_request()
        self._timer.cancel()
        return complete

    def _hang_up(self) -> None:
        with suppress(OSError):  # the connection has already ended
            self.connection.shutdown(SHUT_RDWR)

    def do_GET(self) -> None:
        """Answer a request, unless its host name is that of another site that resolves to this machine."""
        try:
            url = urlsplit(self.path)
        except ValueError:
            self._answer(400, "text/plain", "wrong address")
            return
        if self.headers["Host"] != self.server.name:
            self._answer(403, "text/plain", "not the name of this page")
        elif url.path == "/":
            self._answer(200, "text/html", self.server.live.page())
        elif url.path in ("/part", "/curves"):
            self._data(url.path, dict(parse_qsl(url.query)))
        else:
            self._answer(404, "text/plain", "no such page")

    def _data(self, path: str, query: dict[str, str]) -> None:
        live = self.server.live
        try:
            make_data: Callable[[], dict[str, Any]]
            if path == "/part":
                make_data = partial(live.part, _finite(query["after"]), query["newest"] == "1")
            else:
                make_data = partial(live.curves, int(query["points"]))
        except (LookupError, ValueError):
            self._answer(400, "text/plain", "wrong query")
            return
        try:
            values = make_data()
        except UserError as error:  # temporary: the log may have changed while it was read
            values = {"running": live.running, "state": str(error), "motion": None, "points": 0}
        self._answer(200, "application/json", json.dumps(values, allow_nan=False))

    def _answer(self, status: int, kind: str, text: str) -> None:
        body = text.encode()
        try:
            self.send_response(status)
            self.send_header("Content-Type", f"{kind}; charset=utf-8")
            self.send_header("Content-Length", str(len(body)))
            self.send_header("Cache-Control", "no-store")
            self.send_header("Content-Security-Policy", POLICY)
            self.end_headers()
            self.wfile.write(body)
        except ConnectionError:
            pass  # the browser tab was closed

    def log_message(self, format: str, *args: Any) -> None:
        """Print nothing."""


def _finite(text: str) -> float:
    """Return the finite number that a text represents; raise ValueError for any other text."""
    if not math.isfinite(value := float(text)):
        raise ValueError("not a finite number")
    return value


POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'; connect-src 'self'"
"""Content policy that prevents the page from loading anything from another server."""


def serve(log: Log, port: int = 0, ready: Callable[[str], None] = lambda address: None) -> None:
    """Serve the page of a log to browsers on this machine until KeyboardInterrupt.

    Args:
        log: the log to show.
        port: port number; 0 for any free port.
        ready: function that is called with the address of the page.

    Raises:
        UserError: if the log has nothing to show, or if the port is in use or not allowed.
    """
    live = Live(log)
    try:
        server = _Server(live, port)
    except OSError as error:
        raise UserError(f"port {port}: {error.strerror}") from error
    with server:
        ready(f"http://{server.name}/")
        server.serve_forever()
