"""Tables of the transport in a gas."""

from dataclasses import replace

from idealgas.analysis.core.tables import Table, collision_tables, describe, estimates
from idealgas.analysis.transport.measure import Transport


def transport_tables(result: Transport) -> list[Table]:
    """Tables of collisions, pair distribution at contact, and diffusion of each species."""
    rates, paths = collision_tables(result.collision_rates, result.free_paths)
    contacts = [(f"{contact.species} and {contact.other}", contact.value) for contact in result.contacts]
    diffusion = [
        row
        for entry in result.diffusion
        for row in (
            (f"{entry.species}: D by displacement, length²/time", entry.coefficient),
            (f"{entry.species}: velocity correlation time, time", entry.velocity_correlation_time),
        )
    ]
    return [
        replace(rates, notes=(describe(result.window),)),
        paths,
        estimates("g(r) at contact (no unit)", contacts),
        estimates("Diffusion, theory Enskog's", diffusion),
    ]
