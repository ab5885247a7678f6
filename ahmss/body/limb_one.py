"""One limb of one pose written out in plain floats: what `limb.solve_limb` solves, and where its end is.

The frame loop does this for five limbs in each frame, and the calls and tuples of `solve_limb` cost four times what its
arithmetic does; `solve_limb` is the one to read, and a test holds both to the same numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import acos, atan2, cos, exp, sin, sqrt

from ahmss.body.components import FLOATS, FREE, Quaternion, Vector, saturate
from ahmss.body.limb import SOFTEST, STRAIGHT, SWIVEL, Limb, Rotations

__all__ = ["end_of", "solve_usual"]


def solve_usual(
    limb: Limb, parent: Vector, q_parent: Quaternion, rows: Sequence[Quaternion], target: Sequence[float]
) -> Rotations | None:
    """The rotations of `solve_limb` for one pose and a target with a rotation; None in what is rare and left to it.

    That is a limb that is to point where its own opposite was, or whose hinge has no plane.

    Args:
        limb: its measures.
        parent: the parent's joint in the world, metres.
        q_parent: the parent's rotation, world <- parent.
        rows: the rotations of all links, parent <- child.
        target: place, rotation, weight (8), world.
    """
    (uw, ux, uy, uz), (lw, lx, ly, lz), (ew, ex, ey, ez) = rows[limb.first : limb.first + 3]
    x, y, z, rw, rx, ry, rz, share = target
    # The target as the parent sees it.
    w, a, b, c = q_parent
    px, py, pz = parent
    x, y, z = x - px, y - py, z - pz
    tx, ty, tz = 2.0 * (c * y - b * z), 2.0 * (a * z - c * x), 2.0 * (b * x - a * y)
    x, y, z = x + w * tx - b * tz + c * ty, y + w * ty - c * tx + a * tz, z + w * tz - a * ty + b * tx
    rw, rx, ry, rz = (
        w * rw + a * rx + b * ry + c * rz,
        w * rx - a * rw - b * rz + c * ry,
        w * ry + a * rz - b * rw - c * rx,
        w * rz - a * ry + b * rx - c * rw,
    )
    ax, ay, az = limb.upper
    # b: the lower bone, in the frame of the given upper link.
    vx, vy, vz = limb.lower
    tx, ty, tz = 2.0 * (ly * vz - lz * vy), 2.0 * (lz * vx - lx * vz), 2.0 * (lx * vy - ly * vx)
    bx, by, bz = vx + lw * tx + ly * tz - lz * ty, vy + lw * ty + lz * tx - lx * tz, vz + lw * tz + lx * ty - ly * tx
    # q: the end's given rotation, then the wanted one, on its side; g: where it holds the grip.
    qw, qx = lw * ew - lx * ex - ly * ey - lz * ez, lw * ex + lx * ew + ly * ez - lz * ey
    qy, qz = lw * ey - lx * ez + ly * ew + lz * ex, lw * ez + lx * ey - ly * ex + lz * ew
    gx, gy, gz = limb.grip
    gripped = gx != 0.0 or gy != 0.0 or gz != 0.0
    # x, y, z: the place, seen from the upper joint.
    px, py, pz = limb.base
    x, y, z = x - px, y - py, z - pz
    tx, ty, tz = 2.0 * (uz * y - uy * z), 2.0 * (ux * z - uz * x), 2.0 * (uy * x - ux * y)
    x, y, z = x + uw * tx - uy * tz + uz * ty, y + uw * ty - uz * tx + ux * tz, z + uw * tz - ux * ty + uy * tx
    if share != 1.0:
        x0, y0, z0 = ax + bx, ay + by, az + bz
        if gripped:
            tx, ty, tz = 2.0 * (qy * gz - qz * gy), 2.0 * (qz * gx - qx * gz), 2.0 * (qx * gy - qy * gx)
            x0 += gx + qw * tx + qy * tz - qz * ty
            y0 += gy + qw * ty + qz * tx - qx * tz
            z0 += gz + qw * tz + qx * ty - qy * tx
        x, y, z = x0 + share * (x - x0), y0 + share * (y - y0), z0 + share * (z - z0)
    iw, ix, iy, iz = (
        uw * rw + ux * rx + uy * ry + uz * rz,
        uw * rx - ux * rw - uy * rz + uz * ry,
        uw * ry + ux * rz - uy * rw - uz * rx,
        uw * rz - ux * ry + uy * rx - uz * rw,
    )
    if gripped:
        rw, rx, ry, rz = limb.grip_conjugate
        iw, ix, iy, iz = (
            iw * rw - ix * rx - iy * ry - iz * rz,
            iw * rx + ix * rw + iy * rz - iz * ry,
            iw * ry - ix * rz + iy * rw + iz * rx,
            iw * rz + ix * ry - iy * rx + iz * rw,
        )
    if iw * qw + ix * qx + iy * qy + iz * qz < 0.0:
        iw, ix, iy, iz = -iw, -ix, -iy, -iz
    if share != 1.0:
        iw, ix, iy, iz = qw + share * (iw - qw), qx + share * (ix - qx), qy + share * (iy - qy), qz + share * (iz - qz)
        length = sqrt(iw * iw + ix * ix + iy * iy + iz * iz)
        iw, ix, iy, iz = iw / length, ix / length, iy / length, iz / length
    if gripped:
        tx, ty, tz = 2.0 * (iy * gz - iz * gy), 2.0 * (iz * gx - ix * gz), 2.0 * (ix * gy - iy * gx)
        x -= gx + iw * tx + iy * tz - iz * ty
        y -= gy + iw * ty + iz * tx - ix * tz
        z -= gz + iw * tz + ix * ty - iy * tx
    # h: the hinge.
    aa, bb = ax * ax + ay * ay + az * az, bx * bx + by * by + bz * bz
    scale = 1.0 / sqrt(aa * bb)
    hx, hy, hz = scale * (ay * bz - az * by), scale * (az * bx - ax * bz), scale * (ax * by - ay * bx)
    hy = STRAIGHT + hy if hy > 0.0 else STRAIGHT
    length = sqrt(hx * hx + hy * hy + hz * hz)
    hx, hy, hz = hx / length, hy / length, hz / length
    # The bend.
    distance = sqrt(x * x + y * y + z * z)
    along = (ax * hx + ay * hy + az * hz) * (bx * hx + by * hy + bz * hz)
    straight = ax * bx + ay * by + az * bz - along
    across = ax * (hy * bz - hz * by) + ay * (hz * bx - hx * bz) + az * (hx * by - hy * bx)
    amplitude = sqrt(straight * straight + across * across)
    if amplitude < 1e-12:
        return None
    fixed = aa + bb + 2.0 * along
    longest = sqrt(fixed + 2.0 * amplitude)
    start = (1.0 - limb.soft) * longest
    if distance > start:
        present = sqrt(max(fixed + 2.0 * straight, 0.0))
        start = min(max(present, start), (1.0 - SOFTEST) * longest)
        if distance > start:
            span = longest - start
            distance = start + span * (1.0 - exp(-(distance - start) / span))
    cosine = (distance * distance - fixed) / (2.0 * amplitude)
    if cosine < limb.most_bent:
        cosine = limb.most_bent
    half = 0.5 * (atan2(across, straight) + acos(cosine if cosine < 1.0 else 1.0))
    s = sin(half)
    cw, cx, cy, cz = cos(half), hx * s, hy * s, hz * s
    tx, ty, tz = 2.0 * (cy * bz - cz * by), 2.0 * (cz * bx - cx * bz), 2.0 * (cx * by - cy * bx)
    # s: the swing, from where the bent limb points to where the place is.
    px, py = ax + (bx + cw * tx + cy * tz - cz * ty), ay + (by + cw * ty + cz * tx - cx * tz)
    pz = az + (bz + cw * tz + cx * ty - cy * tx)
    scale = sqrt((px * px + py * py + pz * pz) * (x * x + y * y + z * z))
    sw = scale + (px * x + py * y + pz * z)
    if sw <= 1e-9 * scale:
        return None
    sx, sy, sz = py * z - pz * y, pz * x - px * z, px * y - py * x
    length = sqrt(sw * sw + sx * sx + sy * sy + sz * sz)
    sw, sx, sy, sz = sw / length, sx / length, sy / length, sz / length
    # n: the lower link bent, m: bent and swung.
    nw, nx = cw * lw - cx * lx - cy * ly - cz * lz, cw * lx + cx * lw + cy * lz - cz * ly
    ny, nz = cw * ly - cx * lz + cy * lw + cz * lx, cw * lz + cx * ly - cy * lx + cz * lw
    mw, mx = sw * nw - sx * nx - sy * ny - sz * nz, sw * nx + sx * nw + sy * nz - sz * ny
    my, mz = sw * ny - sx * nz + sy * nw + sz * nx, sw * nz + sx * ny - sy * nx + sz * nw
    # f: the end as seen from the lower link.
    fw, fx = mw * iw + mx * ix + my * iy + mz * iz, mw * ix - mx * iw - my * iz + mz * iy
    fy, fz = mw * iy + mx * iz - my * iw - mz * ix, mw * iz - mx * iy + my * ix - mz * iw
    # Its turn about the lower link's axis goes to that link.
    vx, vy, vz = limb.lower_axis
    low, high = limb.turn
    free_low, free_high = FREE * low, FREE * high
    along = lx * vx + ly * vy + lz * vz
    own = 2.0 * (atan2(along, lw) if lw >= 0.0 else atan2(-along, -lw))
    along = ex * vx + ey * vy + ez * vz
    before = own + 2.0 * (atan2(along, ew) if ew >= 0.0 else atan2(-along, -ew))
    along = fx * vx + fy * vy + fz * vz
    after = own + 2.0 * (atan2(along, fw) if fw >= 0.0 else atan2(-along, -fw))
    turn = after - before
    if not (free_low <= before <= free_high and free_low <= after <= free_high):
        kept = saturate(FLOATS, before, low, high)
        excess = (after - saturate(FLOATS, after, low, high)) - (before - kept)
        if excess != 0.0:  # the swivel: s, m and f anew
            half = 0.5 * saturate(FLOATS, excess, -SWIVEL, SWIVEL)
            s = sin(half) / max(sqrt(x * x + y * y + z * z), 1e-9)
            cw, cx, cy, cz = cos(half), x * s, y * s, z * s
            sw, sx, sy, sz = (
                cw * sw - cx * sx - cy * sy - cz * sz,
                cw * sx + cx * sw + cy * sz - cz * sy,
                cw * sy - cx * sz + cy * sw + cz * sx,
                cw * sz + cx * sy - cy * sx + cz * sw,
            )
            mw, mx = sw * nw - sx * nx - sy * ny - sz * nz, sw * nx + sx * nw + sy * nz - sz * ny
            my, mz = sw * ny - sx * nz + sy * nw + sz * nx, sw * nz + sx * ny - sy * nx + sz * nw
            fw, fx = mw * iw + mx * ix + my * iy + mz * iz, mw * ix - mx * iw - my * iz + mz * iy
            fy, fz = mw * iy + mx * iz - my * iw - mz * ix, mw * iz - mx * iy + my * ix - mz * iw
            along = fx * vx + fy * vy + fz * vz
            after = own + 2.0 * (atan2(along, fw) if fw >= 0.0 else atan2(-along, -fw))
            turn = saturate(FLOATS, after, low, high) - kept
    half = 0.5 * turn
    s = sin(half)
    cw, cx, cy, cz = cos(half), vx * s, vy * s, vz * s
    nw, nx, ny, nz = (
        nw * cw - nx * cx - ny * cy - nz * cz,
        nw * cx + nx * cw + ny * cz - nz * cy,
        nw * cy - nx * cz + ny * cw + nz * cx,
        nw * cz + nx * cy - ny * cx + nz * cw,
    )
    # The end, from a link turned by c more, is c* f.
    fw, fx, fy, fz = (
        cw * fw + cx * fx + cy * fy + cz * fz,
        cw * fx - cx * fw - cy * fz + cz * fy,
        cw * fy + cx * fz - cy * fw - cz * fx,
        cw * fz - cx * fy + cy * fx - cz * fw,
    )
    mw, mx = uw * sw - ux * sx - uy * sy - uz * sz, uw * sx + ux * sw + uy * sz - uz * sy
    my, mz = uw * sy - ux * sz + uy * sw + uz * sx, uw * sz + ux * sy - uy * sx + uz * sw
    # Each on the side of the given one.
    if mw * uw + mx * ux + my * uy + mz * uz < 0.0:
        mw, mx, my, mz = -mw, -mx, -my, -mz
    if nw * lw + nx * lx + ny * ly + nz * lz < 0.0:
        nw, nx, ny, nz = -nw, -nx, -ny, -nz
    if fw * ew + fx * ex + fy * ey + fz * ez < 0.0:
        fw, fx, fy, fz = -fw, -fx, -fy, -fz
    return (mw, mx, my, mz), (nw, nx, ny, nz), (fw, fx, fy, fz)


def end_of(limb: Limb, parent: Vector, q_parent: Quaternion, rows: Sequence[Quaternion]) -> tuple[float, ...]:
    """Place and rotation (7) of a limb's grip in the world, by (4.9) and (4.10).

    Args:
        limb: its measures.
        parent: the parent's joint in the world, metres.
        q_parent: the parent's rotation, world <- parent.
        rows: the rotations of all links, parent <- child.
    """
    w, a, b, c = q_parent
    px, py, pz = parent
    for (x, y, z), (rw, rx, ry, rz) in (
        (limb.base, rows[limb.first]),
        (limb.upper, rows[limb.first + 1]),
        (limb.lower, rows[limb.first + 2]),
    ):
        tx, ty, tz = 2.0 * (b * z - c * y), 2.0 * (c * x - a * z), 2.0 * (a * y - b * x)
        px += x + w * tx + b * tz - c * ty
        py += y + w * ty + c * tx - a * tz
        pz += z + w * tz + a * ty - b * tx
        w, a, b, c = (
            w * rw - a * rx - b * ry - c * rz,
            w * rx + a * rw + b * rz - c * ry,
            w * ry - a * rz + b * rw + c * rx,
            w * rz + a * ry - b * rx + c * rw,
        )
    x, y, z = limb.grip
    tx, ty, tz = 2.0 * (b * z - c * y), 2.0 * (c * x - a * z), 2.0 * (a * y - b * x)
    px, py, pz = (
        px + (x + w * tx + b * tz - c * ty),
        py + (y + w * ty + c * tx - a * tz),
        pz + (z + w * tz + a * ty - b * tx),
    )
    rw, rx, ry, rz = limb.grip_conjugate
    return (
        px,
        py,
        pz,
        w * rw + a * rx + b * ry + c * rz,
        a * rw - w * rx - b * rz + c * ry,
        b * rw - w * ry + a * rz - c * rx,
        c * rw - w * rz - a * ry + b * rx,
    )
