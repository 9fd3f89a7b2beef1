"""Isolators: restoring-force laws, the devices made of them, their tests in a rig, and laws identified from such tests.

`laws` and the `test_rig` come first, `isolator` is a device and its file, `vendor_parts` the makers' tables, `identification`
fits laws to measured loops or data sheets, `rope_loop` and `estimate` predict an isolator from its geometry. Uses the
foundation.
"""
