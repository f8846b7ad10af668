"""Prediction of a disc's next contact, with a disc in the cells around it or with a wall segment of its cell."""

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
    """Shift (x, y), in box lengths, from the recorded position of disc j, candidate k, to its image near disc i."""
    if periodic is not None:
        seen = state.images[U(k)]
        image = (np.int64(seen.x), np.int64(seen.y)) if has_images else NO_IMAGES
        return images_between(periodic, record[U(i)], record[U(j)], image)
    return NO_IMAGES


@inline
def store_contact(state, record, i, j, k, has_images, time, periodic):
    """Store a contact with disc j, candidate k, at a local time as the next contact of disc i."""
    prediction = state.prediction[U(i)]
    prediction.contact = time
    prediction.partner = j
    prediction.partner_count = record[U(j)].count
    if periodic is not None:
        prediction.image_x, prediction.image_y = images_to(state, k, has_images, record, i, j, periodic)


@inline
def filter_colliding(record, state, count, has_images, i, gravity, periodic):
    """Extend the candidates by the other discs in their cells, and keep those that disc i will touch.

    Returns the number of discs kept. Because this number is small, few square roots and quotients have to be computed
    later. The loop contains no branches.
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
def comes_earlier(prediction, ids, disc_id, rank, partner, time, images):
    """Whether a contact of disc `disc_id` precedes its predicted contact; `precedes` orders simultaneous contacts.

    rank: id or wall rank of the partner. partner: number of the partner in the form in which a prediction stores it.
    """
    if time != prediction.contact:
        return time < prediction.contact
    if prediction.partner == partner:
        return image_precedes(disc_id, rank, images, images_of(prediction))
    return precedes(disc_id, rank, disc_id, partner_rank(ids, prediction.partner))


@noinline
def predict_tied_contact(record, ids, state, count, has_images, i, effects):
    """Store disc i's earliest contact with the candidates, applying the rule for simultaneous events.

    Collisions that would not change any digit of a velocity are left out.
    """
    prediction = state.prediction[U(i)]
    a_id = np.int64(ids[U(i)])
    for k in range(count):
        j = state.candidates[U(k)]
        b_id = np.int64(ids[U(j)])
        images = images_to(state, k, has_images, record, i, j, effects.periodic)
        time = contact_time(record[U(i)], record[U(j)], a_id, b_id, images, effects.gravity, effects.periodic, effects)
        if comes_earlier(prediction, ids, a_id, b_id, j, time, images):
            store_contact(state, record, i, j, k, has_images, time, effects.periodic)


@inline
def own_walls(walls, coarse_walls, coarse, disc):
    """Return the wall segments of the cells, coarse or fine, in which a disc is listed."""
    if coarse is not None:
        return coarse_walls if disc.r > coarse.limit else walls
    return walls


@inline
def predict_segment_contact(record, ids, state, i, effects):
    """Store disc i's contact with a wall segment of its cell if it is the disc's earliest contact."""
    disc = record[U(i)]
    cells = own_cells(state.cells, state.coarse, disc)
    walls = own_walls(state.walls, state.coarse_walls, state.coarse, disc)
    link = cells.link[U(i)]
    cell = U(np.int64(link.row) * cells.columns + np.int64(link.column))
    if walls.start[cell] < walls.start[cell + U(1)]:  # rare; an unconditional call would take a third of the time
        disc_id, prediction = np.int64(ids[U(i)]), state.prediction[U(i)]
        predict_entry_contacts(disc, ids, prediction, disc_id, walls, cell, effects.periodic, effects)


@noinline
def predict_entry_contacts(disc, ids, prediction, disc_id, walls, cell, periodic, effects):
    """Store a disc's earliest contact with the segments of its cell if it precedes the predicted contact."""
    for entry in range(walls.start[cell], walls.start[cell + U(1)]):
        k = walls.item[U(entry)]
        images = images_to_item(walls, U(entry), disc, periodic)
        if misses_wall(disc, k, effects.segments, effects.arcs, effects.gravity, periodic, images):
            continue
        passage = passage_of(effects.permeable, disc_id, k)
        time = wall_contact(disc, disc_id, k, effects.arcs, passage, images, effects)
        partner = FIRST_WALL_SEGMENT - k
        if comes_earlier(prediction, ids, disc_id, partner_rank(ids, partner), partner, time, images):
            prediction.contact = time
            prediction.partner = partner
            if periodic is not None:
                prediction.image_x, prediction.image_y = images


@inline
def predict_contact(record, ids, state, i, crossing_code, now, segments, noninteracting, effects):
    """Find disc i's earliest contact with a disc in its cell or the eight cells around it, or with a wall segment.

    If the disc has just crossed into its cell, `crossing_code` is the direction of the crossing (see PREDICTION). The
    predicted contact then remains valid, and only a contact in the cells that have just come within reach can precede
    it. In all other cases `crossing_code` is SIDE_OF_BOX or larger. Simultaneous contacts and contacts at the current
    time are rare and are left to `predict_tied_contact`.
    """
    disc, prediction = record[U(i)], state.prediction[U(i)]
    if crossing_code >= SIDE_OF_BOX:
        prediction.contact = NO_CONTACT
        prediction.partner = -1
    if noninteracting is None:
        if crossing_code < SIDE_OF_BOX:
            count, has_images = new_neighbours(state, state.coarse, i, disc, crossing_code, effects.periodic)
        else:
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
