"""Recordings: a response as one `run.rrd`, and the viewer that opens it. The only room that imports rerun.

The timeline is `sim_time` [s]; `event` holds the same at a few instants alone. What is drawn is thinned to what a picture can
show. Entities:

```text
/world                                  right-handed, z up; bodies that never move stand here
/world/BASE                             the driven base; the camera rides on it, and everything else hangs below it
/world/BASE/BODY                        a body in the base's frame; what is fixed to a body hangs below that body
  .../geoms/box|sphere|...              its shapes; meshes by name
  .../bars                              bars of the mounts that stand on it or carry it
/world/BASE/mounts/ISOLATOR             ropes of all mounts of that device: one mesh, one affine map per mount and row
/world/BASE/labels  /worst  /ring       names of mounts; of the worst one with what it uses, and a ring about it
/world/BASE/forces                      force of each mount on its payload, at equal scale
/world/BASE/acceleration                acceleration of the base
/histories/used                         what is used of limits [%]
/histories/acceleration/x|y|z|total     base, bodies and points [g]
/histories/deflection|force/AXIS        mounts [mm, kN]
/histories/contact/force|gap            stops and pairs of geoms that touched [kN, mm]
  .../0  .../RANK/NAME  .../limit       lines without names; those with names, RANK 1 behind all others; rated travels
  .../RANK/NAME/peak                    the largest value, marked
/loops/AXIS/MOUNT                       frame of the plot
/loops/AXIS/MOUNT/data                  the loop [mm, kN] in the coordinates of the plot;  .../trail  .../cursor
/loops/AXIS/others                      loops of the mounts that have no view of their own
/events                                 log of events
/base  /stops  /NAME                    lanes: phase of the motion, stops, use of the limits of what comes nearest to them
/ghosts                                 the scene with its motion enlarged, over where it began
/plan                                   the mounts from above
/frequencies                            spectra, or the accelerations of a sweep over its frequency
/cursor                                 values at the time cursor
/verdict  /verdicts  /scenario  /peaks  texts
/state/time|base|bodies|points|mounts   if asked for: float64 samples, SI; their `columns` are the names in response.parquet
```

Several runs over each other stand in the same entities, with what is the run's own below its name:

```text
/runs/NAME/world/...  /runs/NAME/state/...    scene, mounts in the run's colour; samples, `read_state(path, run=NAME)`
/histories/acceleration/DIR/KIND/PART         a part in several runs [g];  .../RANK/NAME  .../RANK/NAME/peak
/histories/deflection|force/AXIS/MOUNT        a mount in several runs [mm, kN]
/histories/difference/KIND/PART               how far the others are from the first [g, mm]
/loops/AXIS/MOUNT/data/NAME  /events/NAME     loops and events of a run
/ghosts/NAME/world/...                        bodies in the base's frame, transparent in the run's colour
/differences  /peaks/...  /study              texts
```

Branches of periodic motions have a recording of their own, see `views.recording.branch`.
"""

from lazy_loader import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
