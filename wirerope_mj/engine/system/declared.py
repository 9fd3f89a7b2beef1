"""What an MJCF model declares: mounts, resolved to ids of the compiled model, the base, areas of the deck, payload limits.

Limits are <numeric name="limit/acceleration/rack" data="98.1"/>, areas <text name="area/forward" data="m1 m2 h*"/>.
"""

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path

import mujoco
import numpy as np

from wirerope_mj.engine.system.modal import declared_modes
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.faults import each, reworded
from wirerope_mj.foundation.payload_limits import BETWEEN, KINDS, ON_MOUNTS, PayloadLimit
from wirerope_mj.foundation.plain_text import plain
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.vendor_parts import load_isolator

COINCIDENCE = 1e-6  # largest distance between the two sites of a mount in the modelled geometry [m]
MOUNT, ISOLATOR, BASE = "mount/", "isolator/", "base"
AREA = "area/"
LIMIT, POINT = "limit/", "point/"
COMBINED = LIMIT + "combined_travel"


@dataclass(frozen=True, kw_only=True)
class DeclaredMount:
    """A mount as the model's tuple says it: ids of the model that was compiled from the MJCF alone."""

    name: str
    payload_site: int
    base_site: int
    isolator_name: str
    isolator: Isolator


def check_names(spec: mujoco.MjSpec) -> None:
    """Raise ModelError if a mount's tuple names a site or a text that the model does not have, and say which it has."""
    existing = {
        int(mujoco.mjtObj.mjOBJ_SITE): ("site", sorted(site.name for site in spec.sites if site.name)),
        int(mujoco.mjtObj.mjOBJ_TEXT): ("text", sorted(text.name for text in spec.texts)),
    }
    for element in spec.tuples:
        if MOUNT not in element.name:
            continue
        for kind, name in zip(element.objtype, element.objname, strict=True):
            word, names = existing.get(int(kind), ("", [name]))
            if name not in names:
                raise ModelError(f"tuple {element.name!r}: {word} {name!r} is not in the model. Its {word}s: {names}.")


def check_visible(model: mujoco.MjModel) -> None:
    """Raise ModelError if a name holds a line break or another invisible character."""
    for name in model.names.decode("utf-8", "replace").split("\0"):
        if plain(name) != name:
            raise ModelError(
                f"the name {name!r} in the model holds characters that cannot be seen, such as a line break or an escape "
                "sequence; name that element with letters, digits and signs."
            )


def declared_mounts(
    spec: mujoco.MjSpec, model: mujoco.MjModel, *, folder: Path | None, isolators: Mapping[str, Isolator]
) -> list[DeclaredMount]:
    """Return the mounts in the order of their tuples; isolators come from memory first, then `folder`, then the catalogue."""
    files = {text.name: text.data for text in spec.texts}
    loaded: dict[str, Isolator | None] = {}  # None where it is refused, which is said once

    def mount_of(t: int) -> DeclaredMount | None:
        tuple_name = model.tuple(t).name
        elements = slice(model.tuple_adr[t], model.tuple_adr[t] + model.tuple_size[t])
        kinds = [mujoco.mjtObj(kind) for kind in model.tuple_objtype[elements]]
        if kinds != [mujoco.mjtObj.mjOBJ_SITE, mujoco.mjtObj.mjOBJ_SITE, mujoco.mjtObj.mjOBJ_TEXT]:
            kind_names = [kind.name.removeprefix("mjOBJ_").lower() for kind in kinds]
            raise ModelError(
                f"tuple {tuple_name!r} must hold a payload site, a base site and a text, in this order; it has {kind_names}."
            )
        payload_site, base_site, text = model.tuple_objid[elements].tolist()
        text_name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_TEXT, text)
        key = text_name.split(ISOLATOR, 1)[-1]
        name = tuple_name.replace(MOUNT, "", 1)
        if text_name not in loaded:
            loaded[text_name] = None
            try:
                loaded[text_name] = isolators.get(key) or load_isolator(files[text_name], beside=folder or ".")
            except ModelError as error:
                raise reworded(error, lambda text: ModelError(f"mount {name!r}: {text}")) from None
        if (isolator := loaded[text_name]) is None:
            return None
        return DeclaredMount(name=name, payload_site=payload_site, base_site=base_site, isolator_name=key, isolator=isolator)

    found = each(mount_of, (t for t in range(model.ntuple) if MOUNT in model.tuple(t).name))
    mounts = [mount for mount in found if mount is not None]
    if not mounts:
        raise ModelError(
            "the model has no mount. A mount is a <tuple> in <custom> whose name contains 'mount/', of a payload site, a "
            "base site and a text that names the isolator's file."
        )
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mounts_by_sites: dict[tuple[int, int, str], str] = {}
    names: set[str] = set()
    for mount in mounts:
        sites = [model.site(site).name for site in (mount.payload_site, mount.base_site)]
        if mount.name in names:
            raise ModelError(f"two mounts are called {mount.name!r}.")
        names.add(mount.name)
        distance = float(np.linalg.norm(data.site_xpos[mount.payload_site] - data.site_xpos[mount.base_site]))
        if distance > COINCIDENCE:
            raise ModelError(
                f"mount {mount.name!r}: sites {sites[0]!r} and {sites[1]!r} are {distance:.6g} m apart in the modelled "
                f"geometry; both must lie at the isolator's mid-height, within {COINCIDENCE:g} m."
                + (" Is a position in mm? A model's are in m." if distance > 1.0 else "")
            )
        bodies = [int(model.site_bodyid[site]) for site in (mount.payload_site, mount.base_site)]
        if model.body_weldid[bodies[0]] == model.body_weldid[bodies[1]]:
            raise ModelError(f"mount {mount.name!r}: sites {sites[0]!r} and {sites[1]!r} belong to the same rigid body.")
        key = (mount.payload_site, mount.base_site, mount.isolator_name)
        if key in mounts_by_sites:
            raise ModelError(
                f"mounts {mounts_by_sites[key]!r} and {mount.name!r} place the same isolator {mount.isolator_name!r} between "
                f"the same sites {sites[0]!r} and {sites[1]!r}; remove one, or give it sites of its own."
            )
        mounts_by_sites[key] = mount.name
        if all(law is None for law in mount.isolator.axes.values()):
            raise ModelError(f"mount {mount.name!r}: isolator {mount.isolator.name!r} has no law on any axis.")
    unknown = sorted(set(isolators) - {mount.isolator_name for mount in mounts})
    if unknown:
        known = sorted({mount.isolator_name for mount in mounts})
        raise ModelError(f"no mount uses the isolator {unknown[0]!r}. Isolators that the model names: {known}.")
    return mounts


def _check_ways(model: mujoco.MjModel, mounts: list[DeclaredMount]) -> None:
    """Raise ModelError if a mount stands between two bodies the other way round than most mounts between them."""
    bodies = {mount.name: model.site_bodyid[[mount.payload_site, mount.base_site]] for mount in mounts}
    ways = {name: tuple(model.body_rootid[both].tolist()) for name, both in bodies.items()}
    counts = Counter(ways.values())
    for mount in mounts:
        payload, base = ways[mount.name]
        if 0 < counts[payload, base] < counts[base, payload]:
            names = [model.site(site).name for site in (mount.payload_site, mount.base_site)]
            raise ModelError(
                f"mount {mount.name!r}: its payload site {names[0]!r} is on {model.body(payload).name!r} and its base site "
                f"{names[1]!r} on {model.body(base).name!r}; {counts[base, payload]} other mounts stand the other way "
                "round. Swap its two sites."
            )


def base_body(model: mujoco.MjModel, mounts: list[DeclaredMount]) -> int:
    """Return the id of the base: the child of the world above all base sites that carries no payload site, 0 if fixed."""
    named = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_TUPLE, BASE)
    if named >= 0:
        start, size = model.tuple_adr[named], model.tuple_size[named]
        if size != 1 or model.tuple_objtype[start] != mujoco.mjtObj.mjOBJ_BODY:
            raise ModelError(f"tuple {BASE!r} must hold one body, the base.")
        body = int(model.tuple_objid[start])
        if body and model.body_parentid[body] != 0:
            raise ModelError(f"the base {model.body(body).name!r} must be a child of the world.")
        return body
    ends = [mount.payload_site for mount in mounts], [mount.base_site for mount in mounts]
    roots = [{int(model.body_rootid[model.site_bodyid[site]]) for site in sites} for sites in ends]
    candidates = sorted(roots[1] - roots[0])
    _check_ways(model, mounts)
    if len(candidates) != 1:
        names = [model.body(body).name for body in candidates]
        raise ModelError(
            f"the base is not unique: {names or 'none'} of the bodies carry base sites and no payload site. Name it by "
            '<tuple name="base"><element objtype="body" objname="..."/></tuple> in <custom>.'
        )
    return candidates[0]


def declared_areas(spec: mujoco.MjSpec, mounts: Collection[str]) -> dict[str, tuple[str, ...]]:
    """Return the mounts of every area, in order; ModelError if an area names no mount, or two areas share a mount."""
    areas: dict[str, tuple[str, ...]] = {}
    taken: dict[str, str] = {}
    for text in spec.texts:
        name = text.name
        if AREA not in name:
            continue
        area, patterns = name.replace(AREA, "", 1), text.data.split()
        for pattern in patterns:
            if not any(fnmatchcase(mount, pattern) for mount in mounts):
                raise ModelError(f"text {name!r}: there is no mount {pattern!r}. There are {', '.join(mounts) or 'none'}.")
        areas[area] = tuple(mount for mount in mounts if any(fnmatchcase(mount, pattern) for pattern in patterns))
        for mount in areas[area]:
            if mount in taken:
                raise ModelError(f"text {name!r}: mount {mount!r} stands on area {taken[mount]!r} already.")
            taken[mount] = area
    return areas


def judges_combined_travel(model: mujoco.MjModel) -> bool:
    """Tell whether combined travel of mounts is judged: unless the model sets it to 0."""
    return all(model.numeric(i).data.any() for i in range(model.nnumeric) if model.numeric(i).name.endswith(COMBINED))


def declared_limits(model: mujoco.MjModel, base: int) -> tuple[PayloadLimit, ...]:
    """Return the limits in model order; a limit's subject is its name without `limit/KIND/`.

    Raises:
        ModelError: a limit names nothing that may have it, is of an unknown kind, or has the wrong number of values.
    """
    known = limit_subjects(model, base)
    limits: list[PayloadLimit] = []
    for i in range(model.nnumeric):
        name = model.numeric(i).name
        if LIMIT not in name or name.endswith(COMBINED):
            continue
        prefix, _, rest = name.partition(LIMIT)
        kind, _, subject = rest.partition("/")
        if kind not in KINDS:
            raise ModelError(f"numeric {name!r}: a limit is called limit/KIND/NAME, KIND one of {', '.join(KINDS)}.")
        known_there = known[kind]
        if prefix + subject not in known_there and BETWEEN in subject:
            subject = BETWEEN.join(prefix + part if number else part for number, part in enumerate(subject.split(BETWEEN)))
        subject = prefix + subject
        if not is_subject(subject, kind, known):
            raise ModelError(
                f"numeric {name!r}: there is no {KINDS[kind].subject} {subject!r} that has this. "
                f"There are {known_there or 'none'}."
            )
        try:
            limit = PayloadLimit(kind=kind, name=subject, values=tuple(model.numeric(i).data.tolist()))
        except ValueError as error:
            raise ModelError(f"numeric {name!r}: {error}") from None
        if any((earlier.kind, earlier.name) == (kind, subject) for earlier in limits):
            raise ModelError(f"numeric {name!r}: the {kind} of {subject!r} is limited twice.")
        limits.append(limit)
    return tuple(limits)


def is_subject(name: str, kind: str, known: Mapping[str, Sequence[str]]) -> bool:
    """Tell whether a limit of this kind may apply to a subject: a body, a point, for a clearance also two points."""
    if name in known[kind]:
        return True
    ends = name.split(BETWEEN)
    return kind == "clearance" and len(ends) == 2 and ends[0] != ends[1] and set(ends) <= set(known["point"])


def limit_subjects(model: mujoco.MjModel, base: int) -> dict[str, list[str]]:
    """Return the bodies, points and mounts to which limits of each kind may apply, and all points as "point"."""
    points = [model.site(s).name.replace(POINT, "", 1) for s in range(model.nsite) if POINT in model.site(s).name]
    modal = {mode.body for mode in declared_modes(model)}
    bodies = [b for b in range(1, model.nbody) if model.body_weldid[b] not in (0, base) and b not in modal]
    shaped = [b for b in bodies if model.body_geomnum[b]]  # a body without geoms has no corners
    every = [*(model.body(b).name for b in bodies), *points]
    tuples = (model.tuple(number).name for number in range(model.ntuple))
    mounts = [name.replace(MOUNT, "", 1) for name in tuples if MOUNT in name]
    corners = [*(model.body(b).name for b in shaped), *points]
    return dict.fromkeys(KINDS, every) | {"clearance": corners, "point": points} | dict.fromkeys(ON_MOUNTS, mounts)
