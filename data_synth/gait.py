"""Locomotion: footsteps planned along a ground path, and the body carried over them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from data_synth.body import TOE_HEIGHT, Pose, lower_into_reach, standing_height
from data_synth.curves import ease
from projflow_lite.skeleton import FPS

MARGIN = 40
"""Frames by which a path is longer than the clip at either end: feet land ahead of the body."""

# Pitch of a walking foot over one cycle that begins with heel strike, degrees.
WALK_PITCH = ((0.0, -16), (0.09, 0), (0.32, 0), (0.60, 45), (0.70, 66), (0.90, -6), (1.0, -16))
RUN_PITCH = ((0.0, -4), (0.06, 0), (0.16, 0), (0.34, 50), (0.50, 70), (0.85, 8), (1.0, -4))


@dataclass
class Gait:
    """How `n` bodies step; every array is ``(n,)``.

    Attributes:
        cadence: steps a second.
        phase: where in the cycle of the left foot the clip begins, 0..1.
        duty: share of the cycle that a foot stands.
        width: distance between the feet, metres.
        lift: how high a swinging toe rises, metres.
        bob, sway: half the rise and half the sideways travel of the pelvis, metres.
        pitch: share of the full roll of the foot.
        swing: angle of the arms ahead and back, radians.
        elbow: mean bend of the elbows, radians.
        lean: of the trunk, radians.
        crouch: how far the pelvis is below straight legs, metres.
        running: whether the foot rolls as in running.
    """

    cadence: NDArray
    phase: NDArray
    duty: NDArray
    width: NDArray
    lift: NDArray
    bob: NDArray
    sway: NDArray
    pitch: NDArray
    swing: NDArray
    elbow: NDArray
    lean: NDArray
    crouch: NDArray
    running: bool = False


@dataclass
class Path:
    """Ground path of the body, longer than the clip by `MARGIN` frames at either end.

    Attributes:
        place: ``(n, frames + 2 MARGIN, 2)`` x and z, metres.
        heading: ``(n, frames + 2 MARGIN)`` direction the body faces, radians to the left of +z.
    """

    place: NDArray
    heading: NDArray

    @property
    def frames(self) -> int:
        """Frames of the clip itself."""
        return self.heading.shape[1] - 2 * MARGIN

    def at(self, frame: NDArray) -> tuple[NDArray, NDArray]:
        """Place ``(n, k, 2)`` and heading ``(n, k)`` at fractional frames ``(n, k)``."""
        last = self.heading.shape[1] - 2
        position = (frame + MARGIN).clip(0, last + 0.999)
        low = position.astype(int)
        share = position - low
        rows = np.arange(len(frame))[:, None]
        heading = (1 - share) * self.heading[rows, low] + share * self.heading[rows, low + 1]
        share = share[..., None]
        return (1 - share) * self.place[rows, low] + share * self.place[rows, low + 1], heading


def path_of(velocity: NDArray, drift: NDArray, heading: NDArray) -> Path:
    """Integrate a path that starts at the origin, facing +z.

    Args:
        velocity: ``(n, frames + 2 MARGIN)`` speed in the direction the body faces, m/s.
        drift: the same, speed to the body's left.
        heading: the same, radians; shifted so that the first frame of the clip faces +z.
    """
    heading = heading - heading[:, MARGIN : MARGIN + 1]
    ahead = np.stack([np.sin(heading), np.cos(heading)], axis=-1)
    left = np.stack([np.cos(heading), -np.sin(heading)], axis=-1)
    step = (velocity[..., None] * ahead + drift[..., None] * left) / FPS
    place = np.cumsum(step, axis=1)
    return Path(place - place[:, MARGIN : MARGIN + 1], heading)


def foot_pitch(cycle: NDArray, running: bool) -> NDArray:
    """Pitch of the foot, radians, at a place 0..1 in its cycle."""
    where, degrees = np.transpose(RUN_PITCH if running else WALK_PITCH)
    grid = np.arange(256) / 256
    table = np.interp(grid, where, np.radians(degrees))
    # Rounded corners, and flat where it was flat: no foot tips over in one frame.
    kernel = np.hanning(21)
    table = np.convolve(np.tile(table, 3), kernel / kernel.sum(), mode="same")[256:512]
    return np.interp(cycle, grid, table, period=1.0)


def steps(gait: Gait, path: Path) -> tuple[NDArray, NDArray, NDArray]:
    """Toe ``(n, frames, 2, 3)``, yaw and pitch ``(n, frames, 2)`` of both feet."""
    frames = np.arange(path.frames)
    per_frame = gait.cadence / 2 / FPS
    toe = np.zeros((len(per_frame), path.frames, 2, 3))
    yaw, pitch = np.zeros(toe.shape[:3]), np.zeros(toe.shape[:3])
    duty = gait.duty[:, None]
    for s, sign in enumerate((1.0, -1.0)):
        phase = gait.phase[:, None] + 0.5 * s + frames * per_frame[:, None]
        number, cycle = np.floor(phase), phase % 1.0

        def stand(k: NDArray, s: int = s, sign: float = sign) -> tuple[NDArray, NDArray]:
            """Where the foot stands in its k-th cycle: beside the body at mid stance."""
            middle = (k + duty / 2 - gait.phase[:, None] - 0.5 * s) / per_frame[:, None]
            place, heading = path.at(middle)
            left = np.stack([np.cos(heading), -np.sin(heading)], axis=-1)
            ahead = np.stack([np.sin(heading), np.cos(heading)], axis=-1)
            side = sign * gait.width[:, None, None] / 2
            return place + side * left + 0.05 * ahead, heading + sign * 0.1

        here, facing = stand(number)
        there, facing_next = stand(number + 1)
        swing = ((cycle - duty) / (1 - duty)).clip(0, 1)
        share = 0.35 * ease(swing) + 0.65 * (0.5 - 0.5 * np.cos(np.pi * swing))
        toe[:, :, s, [0, 2]] = here + share[..., None] * (there - here)
        toe[:, :, s, 1] = TOE_HEIGHT + gait.lift[:, None] * np.sin(np.pi * swing**0.8) ** 1.5
        yaw[:, :, s] = facing + share * (facing_next - facing)
        pitch[:, :, s] = gait.pitch[:, None] * foot_pitch(cycle, gait.running)
    return toe, yaw, pitch


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
    place, heading = path.at(np.broadcast_to(frames, phase.shape))
    left = np.stack([np.cos(heading), -np.sin(heading)], axis=-1)
    pelvis = np.zeros((*phase.shape, 3))
    pelvis[..., [0, 2]] = place + (gait.sway[:, None] * np.cos(middle))[..., None] * left
    rise = -1.0 if gait.running else 1.0
    pelvis[..., 1] = (standing_height(bones) - gait.crouch)[:, None]
    pelvis[..., 1] += rise * gait.bob[:, None] * np.cos(2 * middle)
    stride = np.minimum(gait.swing[:, None], 0.6)
    turn_ahead = -0.16 * stride * np.cos(angle)  # the hip of the leading foot goes ahead
    pose = Pose(
        pelvis=pelvis,
        yaw=heading + turn_ahead,
        pitch=np.broadcast_to(0.35 * gait.lean[:, None], phase.shape),
        roll=-0.05 * np.cos(middle),
        bend=np.broadcast_to(0.65 * gait.lean[:, None], phase.shape) + 0.015 * np.cos(2 * angle),
        twist=-2.0 * turn_ahead,
        tilt=0.05 * np.cos(middle),
        nod=np.broadcast_to(-0.6 * gait.lean[:, None], phase.shape),
        look=turn_ahead,
        toe=toe,
        foot_yaw=foot_yaw,
        foot_pitch=pitch,
        hand=swinging_hands(gait, angle, bones),
    )
    lower_into_reach(pose, bones, level=0.9)
    return pose


def swinging_hands(gait: Gait, angle: NDArray, bones: NDArray) -> NDArray:
    """Wrists relative to their shoulders, ``(n, frames, 2, 3)``: each swings with the other leg."""
    hands = np.zeros((*angle.shape, 2, 3))
    for s, sign in enumerate((1.0, -1.0)):
        ahead = -sign * np.cos(angle)  # the left foot is ahead at angle 0: the right hand is too
        flex = gait.swing[:, None] * (ahead + 0.15)
        elbow = gait.elbow[:, None] + 0.35 * gait.swing[:, None] * (ahead + 1)
        hands[:, :, s] = hang(flex, elbow, sign * 0.11, bones)
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
