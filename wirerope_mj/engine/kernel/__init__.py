"""The equations of motion of bodies that never touch, written for lanes; MuJoCo describes the bodies and judges the result.

May use `engine.control`'s layouts and `engine.system`. A model that holds more than these equations stays MuJoCo's: `fits` says
why.
"""
