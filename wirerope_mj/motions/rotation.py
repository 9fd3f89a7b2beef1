"""Rotation of the base: kinematics of roll, pitch and yaw, angles of any size.

The base turns from its modelled orientation by R = Rz(yaw) Ry(pitch) Rx(roll) about the world's axes as modelled: roll first,
about the fixed x axis, then pitch about the fixed y, then yaw about the fixed z axis. With e_x, e_y, e_z and a prime for d/dt,

    w = yaw' e_z + pitch' Rz e_y + roll' Rz Ry e_x

is the angular velocity in the world's axes, and its derivative the angular acceleration.
"""

import numpy as np

from wirerope_mj.foundation.arrays import Array


def rotation_of(angles: Array) -> Array:
    """Return the rotations R, (n, 3, 3), of roll, pitch and yaw, (n, 3) [rad]."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(angles.T), np.sin(angles.T)
    rows = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def angular_motion(angles: Array, rates: Array, accelerations: Array) -> tuple[Array, Array]:
    """Return angular velocity [rad/s] and acceleration [rad/s^2], world axes, (n, 3) each.

    Args:
        angles: roll, pitch and yaw [rad], (n, 3).
        rates: their rates [rad/s], (n, 3).
        accelerations: their second derivatives [rad/s^2], (n, 3).
    """
    (_, cp, cy), (_, sp, sy) = np.cos(angles.T), np.sin(angles.T)
    (roll, pitch, yaw), zero = rates.T, np.zeros(len(angles))
    e_pitch, e_roll = np.stack([-sy, cy, zero], axis=1), np.stack([cy * cp, sy * cp, -sp], axis=1)  # axes of pitch and roll
    about_z = np.array([0.0, 0.0, 1.0])
    turn_of_roll = yaw[:, np.newaxis] * about_z + pitch[:, np.newaxis] * e_pitch  # with which the axis of roll turns
    velocity = turn_of_roll + roll[:, np.newaxis] * e_roll
    second_roll, second_pitch, second_yaw = (part[:, np.newaxis] for part in accelerations.T)
    acceleration = second_yaw * about_z + second_pitch * e_pitch + second_roll * e_roll
    acceleration = acceleration + (yaw * pitch)[:, np.newaxis] * np.cross(about_z, e_pitch)
    return velocity, acceleration + roll[:, np.newaxis] * np.cross(turn_of_roll, e_roll)


def swing(centre: Array, order: int, angles: Array, rates: Array, accelerations: Array) -> Array:
    """Return displacement (order 0), velocity (1) or acceleration (2) of the base's origin as it turns about a centre, (n, 3).

    `centre` is from the origin as modelled, (3,) [m]: the origin is at centre - R centre. Others are as in `angular_motion`.
    """
    arm = -(rotation_of(angles) @ centre)
    if order == 0:
        return centre + arm
    velocity, acceleration = angular_motion(angles, rates, accelerations)
    if order == 1:
        return np.cross(velocity, arm)
    return np.cross(acceleration, arm) + np.cross(velocity, np.cross(velocity, arm))
