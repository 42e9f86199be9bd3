"""Locomotion: footsteps planned along a ground path, and the body carried over them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from data_synth.body import TOE_HEIGHT, Pose, ease_ankles, lower_into_reach, standing_height
from data_synth.curves import ease
from projflow_lite.skeleton import FPS

MARGIN = 40
"""Frames by which a path is longer than the clip at either end: feet land ahead of the body."""

# Pitch of a foot over one cycle that begins with heel strike, degrees: flat until the heel rises.
WALK_PITCH = (
    (0.0, -24), (0.05, -13), (0.10, -4), (0.14, 0), (0.36, 0), (0.50, 17), (0.56, 36), (0.62, 60),
    (0.67, 69), (0.72, 58), (0.80, 28), (0.86, 5), (0.92, -13), (0.97, -23), (1.0, -24),
)  # fmt: skip
RUN_PITCH = (
    (0.0, -6), (0.06, 0), (0.16, 0), (0.26, 22), (0.34, 55), (0.44, 84), (0.54, 88), (0.66, 60),
    (0.80, 18), (0.92, -4), (1.0, -6),
)  # fmt: skip
TYPICAL_STEP = 0.25
"""Metres; a foot that moves less than a few times this is lifted and rolled less, too."""


@dataclass
class Gait:
    """How `n` bodies step; every array is ``(n,)``.

    Attributes:
        cadence: steps a second.
        phase: where in the cycle of the left foot the clip begins, 0..1.
        duty: share of the cycle that a foot stands.
        width: distance between the feet, metres.
        lift: how high a swinging toe rises, metres.
        bob, sway, surge: half the rise, half the sideways travel and half the hurrying ahead of the
            pelvis, metres.
        jolt: how far a heel strike makes the pelvis dip, metres.
        pitch: share of the full roll of the foot.
        swing: angle of the arms ahead and back, radians.
        elbow: mean bend of the elbows, radians.
        arms_out: angle of the arms away from the body, radians.
        lean: of the trunk, radians.
        crouch: how far the pelvis is below straight legs, metres.
        running: whether the foot rolls as in running.
        marching: whether feet are lifted fully even if they come down where they were.
    """

    cadence: NDArray
    phase: NDArray
    duty: NDArray
    width: NDArray
    lift: NDArray
    bob: NDArray
    sway: NDArray
    surge: NDArray
    jolt: NDArray
    pitch: NDArray
    swing: NDArray
    elbow: NDArray
    arms_out: NDArray
    lean: NDArray
    crouch: NDArray
    running: bool = False
    marching: bool = False


@dataclass
class Path:
    """Ground path of the body, longer than the clip by `MARGIN` frames at either end.

    Attributes:
        place: ``(n, frames + 2 MARGIN, 2)`` x and z, metres.
        heading: ``(n, frames + 2 MARGIN)`` direction the body faces, radians to the left of +z.
        effort: the same, 1 where the body is on its way and 0 where it stands: bob, sway, hips and
            arms go with it.
    """

    place: NDArray
    heading: NDArray
    effort: NDArray

    @property
    def frames(self) -> int:
        """Frames of the clip itself."""
        return self.heading.shape[1] - 2 * MARGIN

    def at(self, frame: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        """Place ``(n, k, 2)``, heading and effort ``(n, k)`` at fractional frames ``(n, k)``."""
        last = self.heading.shape[1] - 2
        position = (frame + MARGIN).clip(0, last + 0.999)
        low = position.astype(int)
        share = position - low
        rows = np.arange(len(frame))[:, None]
        heading, effort = (
            (1 - share) * curve[rows, low] + share * curve[rows, low + 1]
            for curve in (self.heading, self.effort)
        )
        share = share[..., None]
        place = (1 - share) * self.place[rows, low] + share * self.place[rows, low + 1]
        return place, heading, effort


def path_of(
    velocity: NDArray, drift: NDArray, heading: NDArray, effort: NDArray | float = 1.0
) -> Path:
    """Integrate a path that starts at the origin, facing +z.

    Args:
        velocity: ``(n, frames + 2 MARGIN)`` speed in the direction the body faces, m/s.
        drift: the same, speed to the body's left.
        heading: the same, radians; shifted so that the first frame of the clip faces +z.
        effort: the same, 0 where the body stands.
    """
    heading = heading - heading[:, MARGIN : MARGIN + 1]
    ahead = np.stack([np.sin(heading), np.cos(heading)], axis=-1)
    left = np.stack([np.cos(heading), -np.sin(heading)], axis=-1)
    step = (velocity[..., None] * ahead + drift[..., None] * left) / FPS
    place = np.cumsum(step, axis=1)
    effort = np.broadcast_to(effort, heading.shape)
    return Path(place - place[:, MARGIN : MARGIN + 1], heading, effort)


def foot_pitch(cycle: NDArray, running: bool) -> NDArray:
    """Pitch of the foot, radians, at a place 0..1 in its cycle."""
    where, degrees = np.transpose(RUN_PITCH if running else WALK_PITCH)
    grid = np.arange(256) / 256
    table = np.interp(grid, where, np.radians(degrees))
    # Rounded corners, and flat where it was flat: no foot tips over in one frame.
    kernel = np.hanning(25)
    table = np.convolve(np.tile(table, 3), kernel / kernel.sum(), mode="same")[256:512]
    return np.interp(cycle, grid, table, period=1.0)


def forward_share() -> NDArray:
    """How far a foot has come at 257 places of its swing: quick away, steady, and quickly down."""
    speed = np.sin(np.pi * (np.arange(256) + 0.5) / 256) ** 0.9
    return np.concatenate([[0.0], np.cumsum(speed) / speed.sum()])


def steps(gait: Gait, path: Path) -> tuple[NDArray, NDArray, NDArray]:
    """Toe ``(n, frames, 2, 3)``, yaw and pitch ``(n, frames, 2)`` of both feet."""
    frames = np.arange(path.frames)
    per_frame = gait.cadence[:, None] / 2 / FPS
    toe = np.zeros((len(per_frame), path.frames, 2, 3))
    yaw, pitch = np.zeros(toe.shape[:3]), np.zeros(toe.shape[:3])
    duty = gait.duty[:, None]
    for s, sign in enumerate((1.0, -1.0)):
        start = gait.phase[:, None] + 0.5 * s
        phase = start + frames * per_frame
        number, cycle = np.floor(phase), phase % 1.0
        # Where the foot stands in its previous, this and its next cycle: beside the body as it is
        # at the middle of the stance.
        stands = []
        for k in (number - 1, number, number + 1):
            place, heading, effort = path.at((k + duty / 2 - start) / per_frame)
            left = np.stack([np.cos(heading), -np.sin(heading)], axis=-1)
            ahead = np.stack([np.sin(heading), np.cos(heading)], axis=-1)
            beside = sign * gait.width[:, None, None] / 2 * left
            front = (0.05 + 0.08 * (1 - effort))[..., None] * ahead
            stands.append((place + beside + front, heading + sign * 0.1))
        moves, moved = (size_of_step(gait, stands[k], stands[k + 1]) for k in (1, 0))
        (here, facing), (there, facing_next) = stands[1:]
        swing = ((cycle - duty) / (1 - duty)).clip(0, 1)
        share = np.interp(swing, np.arange(257) / 256, forward_share())
        toe[:, :, s, [0, 2]] = here + share[..., None] * (there - here)
        lift = gait.lift[:, None] * moves
        toe[:, :, s, 1] = TOE_HEIGHT + lift * np.sin(np.pi * swing**0.62) ** 1.5
        yaw[:, :, s] = facing + share * (facing_next - facing)
        # The foot comes down as the last step was, and rolls off as the next one will be.
        roll = gait.pitch[:, None] * np.where(cycle < 0.15, moved, moves)
        pitch[:, :, s] = roll * foot_pitch(cycle, gait.running)
    return toe, yaw, pitch


def size_of_step(
    gait: Gait, here: tuple[NDArray, NDArray], there: tuple[NDArray, NDArray]
) -> NDArray:
    """0 for a foot that stays where it is, near 1 for a full step, ``(n, frames)``."""
    if gait.marching:
        return np.ones_like(here[1])
    distance = np.linalg.norm(there[0] - here[0], axis=-1) + 0.4 * np.abs(there[1] - here[1])
    return np.tanh(distance / TYPICAL_STEP)


def walk_over(gait: Gait, path: Path, bones: NDArray) -> Pose:
    """The whole body in locomotion; hands swing with the opposite foot."""
    toe, foot_yaw, pitch = steps(gait, path)
    frames = np.arange(path.frames)
    phase = gait.phase[:, None] + frames * (gait.cadence / 2 / FPS)[:, None]
    angle = 2 * np.pi * phase
    duty = gait.duty[:, None]
    # The left foot's stance has its middle at duty / 2: over it the body is highest (walking) or
    # lowest (running), and sways to the left.
    middle = 2 * np.pi * (phase - duty / 2)
    place, heading, effort = path.at(np.broadcast_to(frames, phase.shape))
    left = np.stack([np.cos(heading), -np.sin(heading)], axis=-1)
    pelvis = np.zeros((*phase.shape, 3))
    sideways = effort * gait.sway[:, None] * np.cos(middle)
    # Over a standing foot the body is slowest; it hurries on between two feet.
    onward = effort * gait.surge[:, None] * (np.sin(2 * middle) - 0.1 * np.sin(4 * middle))
    ahead = np.stack([np.sin(heading), np.cos(heading)], axis=-1)
    pelvis[..., [0, 2]] = place + sideways[..., None] * left - onward[..., None] * ahead
    rise = -1.0 if gait.running else 1.0
    pelvis[..., 1] = (standing_height(bones) - gait.crouch)[:, None]
    bounce = np.cos(2 * middle + 0.4) - (0.0 if gait.running else 0.2) * np.cos(4 * middle)
    jolt = effort * gait.jolt[:, None] * ringing(2 * phase % 1.0, gait.cadence)
    pelvis[..., 1] += rise * effort * gait.bob[:, None] * bounce - jolt
    stride = effort * np.minimum(2.5 * gait.swing[:, None], 0.7)
    turn_ahead = -0.28 * stride * np.cos(angle)  # the hip of the leading foot goes ahead
    pose = Pose(
        pelvis=pelvis,
        yaw=heading + turn_ahead,
        pitch=np.broadcast_to(0.35 * gait.lean[:, None], phase.shape),
        roll=-0.05 * effort * np.cos(middle),
        bend=0.65 * gait.lean[:, None] + 0.02 * effort * np.cos(2 * angle) + 3.0 * jolt,
        twist=-1.6 * turn_ahead,
        tilt=0.05 * effort * np.cos(middle),
        nod=-0.6 * gait.lean[:, None] - 0.015 * effort * np.cos(2 * angle),
        look=0.8 * turn_ahead,
        toe=toe,
        foot_yaw=foot_yaw,
        foot_pitch=pitch,
        hand=swinging_hands(gait, angle, effort, bones),
    )
    lower_into_reach(pose, bones, level=0.85)
    ease_ankles(pose, bones)
    return pose


def ringing(since: NDArray, cadence: NDArray) -> NDArray:
    """What a heel strike sends through the body, dying away before the next, ``(n, frames)``.

    Args:
        since: ``(n, frames)`` 0..1, how much of the step has passed since the foot struck.
        cadence: ``(n,)`` steps a second.
    """
    t = since / cadence[:, None]
    fade = 1 - ease(since)  # nothing is left at the next strike
    return np.exp(-t / 0.09) * np.sin(2 * np.pi * 4.2 * t) * fade


def swinging_hands(gait: Gait, angle: NDArray, effort: NDArray, bones: NDArray) -> NDArray:
    """Wrists relative to their shoulders, ``(n, frames, 2, 3)``: each swings with the other leg."""
    hands = np.zeros((*angle.shape, 2, 3))
    swing = effort * gait.swing[:, None]
    for s, sign in enumerate((1.0, -1.0)):
        # The left foot is ahead at angle 0, and the right hand is too. A leg goes back more slowly
        # than it comes forward, and so does the arm that goes with it.
        there = angle + (np.pi if sign > 0 else 0.0)
        ahead = np.cos(there + 0.2 * (np.cos(there) - 1))
        flex = swing * ahead + 0.06
        elbow = gait.elbow[:, None] + 0.45 * swing * ahead
        hands[:, :, s] = hang(flex, elbow, sign * gait.arms_out[:, None], bones)
    return hands


def hang(flex: NDArray, elbow: NDArray, out: NDArray | float, bones: NDArray) -> NDArray:
    """Wrist relative to the shoulder of an arm, ``(n, frames, 3)``.

    Args:
        flex: ``(n, frames)`` angle of the upper arm ahead of hanging, radians.
        elbow: ``(n, frames)`` bend of the elbow, 0 is straight.
        out: angle away from the body; positive is to +x.
        bones: ``(n, 22, 3)``.
    """
    upper, lower = (np.linalg.norm(bones[:, j], axis=-1)[:, None] for j in (18, 20))
    fore = flex + elbow
    y = -upper * np.cos(flex) - lower * np.cos(fore)
    z = upper * np.sin(flex) + lower * np.sin(fore)
    x = -y * np.tan(out)
    return np.stack([np.broadcast_to(x, y.shape), y, z], axis=-1)
