"""Next contact of a disc: with the discs in the cells around it, and with the wall segments of its own cell."""

import numpy as np

from idealgas.engine.event_driven.cells import own_cells
from idealgas.engine.event_driven.neighbours import neighbours, new_neighbours
from idealgas.engine.event_driven.prediction import (
    FIRST_WALL_SEGMENT,
    NO_CONTACT,
    SIDE_OF_BOX,
    image_precedes,
    images_of,
    partner_rank,
    precedes,
)
from idealgas.engine.event_driven.wall_cells import images_to_item
from idealgas.jit import inline, noinline
from idealgas.physics.arc import misses_wall, wall_contact
from idealgas.physics.disc_disc import collision_time, contact_time, will_collide
from idealgas.physics.periodic import NO_IMAGES, images_between
from idealgas.physics.permeable import passage_of

U = np.uintp


@inline
def images_to(state, k, has_images, record, i, j, periodic):
    """Numbers of box lengths (x, y) between the records of disc i and of disc j, which is candidate k."""
    if periodic is not None:
        seen = state.images[U(k)]
        image = (np.int64(seen.x), np.int64(seen.y)) if has_images else NO_IMAGES
        return images_between(periodic, record[U(i)], record[U(j)], image)
    return NO_IMAGES


@inline
def store_contact(state, record, i, j, k, has_images, time, periodic):
    """Store the contact of disc i with disc j, candidate k, at a local time as disc i's next."""
    prediction = state.prediction[U(i)]
    prediction.contact = time
    prediction.partner = j
    prediction.partner_count = record[U(j)].count
    if periodic is not None:
        prediction.image_x, prediction.image_y = images_to(state, k, has_images, record, i, j, periodic)


@inline
def filter_colliding(record, state, count, has_images, i, gravity, periodic):
    """Keep of the candidates, extended by the further discs of their cells, those that disc i will touch.

    Returns their number. Few are left, so that only few roots and quotients are computed; the loop has no branches.
    """
    candidates = state.candidates
    disc = record[U(i)]
    kept = 0
    k = 0
    while k < count:
        j = candidates[U(k)]
        behind = state.cells.link[U(j)].next
        candidates[U(count)] = behind
        if periodic is not None and has_images:
            state.images[U(count)] = state.images[U(k)]
        count += 1 if behind >= 0 else 0
        images = images_to(state, k, has_images, record, i, j, periodic)
        candidates[U(kept)] = j
        if periodic is not None and has_images:
            state.images[U(kept)] = state.images[U(k)]
        kept += 1 if will_collide(disc, record[U(j)], gravity, periodic, images) else 0
        k += 1
    return kept


@inline
def comes_earlier(prediction, ids, own, rank, partner, time, images):
    """Whether a contact of disc `own` (id) comes before the one predicted for it; of one time by the rule for those.

    rank: of what it meets. partner: the same as it is stored in a prediction.
    """
    if time != prediction.contact:
        return time < prediction.contact
    if prediction.partner == partner:
        return image_precedes(own, rank, images, images_of(prediction))
    return precedes(own, rank, own, partner_rank(ids, prediction.partner))


@noinline
def predict_tied_contact(record, ids, state, count, has_images, i, effects):
    """Store disc i's earliest contact among the candidates, by the rule for simultaneous events.

    It leaves out collisions that would change no digit of a velocity.
    """
    prediction = state.prediction[U(i)]
    own = np.int64(ids[U(i)])
    for k in range(count):
        j = state.candidates[U(k)]
        other = np.int64(ids[U(j)])
        images = images_to(state, k, has_images, record, i, j, effects.periodic)
        time = contact_time(
            record[U(i)], record[U(j)], own, other, effects.gravity, effects.restitution, effects.periodic, images
        )
        if comes_earlier(prediction, ids, own, other, j, time, images):
            store_contact(state, record, i, j, k, has_images, time, effects.periodic)


@inline
def own_walls(walls, coarse_walls, coarse, disc):
    """Wall segments by cell, of the cells that a disc is in."""
    if coarse is not None:
        return coarse_walls if disc.r > coarse.limit else walls
    return walls


@inline
def predict_segment_contact(record, ids, state, i, effects):
    """Store disc i's contact with a wall segment of its cell if that is its earliest."""
    disc = record[U(i)]
    cells = own_cells(state.cells, state.coarse, disc)
    walls = own_walls(state.walls, state.coarse_walls, state.coarse, disc)
    link = cells.link[U(i)]
    cell = U(np.int64(link.row) * cells.columns + np.int64(link.column))
    first, last = walls.start[cell], walls.start[cell + U(1)]
    if first < last:  # seldom: to call a function for every disc would take a third of the time
        own, prediction = np.int64(ids[U(i)]), state.prediction[U(i)]
        predict_entry_contacts(disc, ids, prediction, own, walls, first, last, effects.periodic, effects)


@noinline
def predict_entry_contacts(disc, ids, prediction, own, walls, first, last, periodic, effects):
    """Store a disc's contact with a wall segment, of some entries of cells, if that is its earliest."""
    for entry in range(first, last):
        k = walls.item[U(entry)]
        images = images_to_item(walls, U(entry), disc, periodic)
        if misses_wall(disc, k, effects.segments, effects.arcs, effects.gravity, periodic, images):
            continue
        passage = passage_of(effects.permeable, own, k)
        segments, arcs = effects.segments, effects.arcs
        time = wall_contact(
            disc, own, k, segments, arcs, passage, effects.gravity, effects.restitution, periodic, images
        )
        partner = FIRST_WALL_SEGMENT - k
        if comes_earlier(prediction, ids, own, partner_rank(ids, partner), partner, time, images):
            prediction.contact = time
            prediction.partner = partner
            if periodic is not None:
                prediction.image_x, prediction.image_y = images


@inline
def predict_contact(record, ids, state, i, crossing_code, now, segments, effects):
    """Find disc i's earliest contact with a disc in its own cell or the eight around it, or with a wall segment.

    crossing_code: direction in which it has just crossed into its cell, see PREDICTION: then the contact found before
    stays valid, and may only be preceded by one in the cells that came within reach. SIDE_OF_BOX or more otherwise.
    Simultaneous contacts and contacts at the present time are rare; `predict_tied_contact` decides them.
    """
    disc, prediction = record[U(i)], state.prediction[U(i)]
    if crossing_code < SIDE_OF_BOX:
        count, has_images = new_neighbours(state, state.coarse, i, disc, crossing_code, effects.periodic)
    else:
        prediction.contact = NO_CONTACT
        prediction.partner = -1
        count, has_images = neighbours(state, state.coarse, i, disc, effects.periodic)
    count = filter_colliding(record, state, count, has_images, i, effects.gravity, effects.periodic)
    best = prediction.contact
    chosen = -1
    tied = False
    for k in range(count):
        j = state.candidates[U(k)]
        images = images_to(state, k, has_images, record, i, j, effects.periodic)
        time = collision_time(disc, record[U(j)], effects.gravity, effects.periodic, images)
        tied |= time == best
        chosen = k if time < best else chosen
        best = min(time, best)
    if tied | (best <= now):
        predict_tied_contact(record, ids, state, count, has_images, i, effects)
    elif chosen >= 0:
        store_contact(state, record, i, state.candidates[U(chosen)], chosen, has_images, best, effects.periodic)
    if segments is not None:
        predict_segment_contact(record, ids, state, i, effects)
