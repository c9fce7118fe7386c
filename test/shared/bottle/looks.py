"""Looks on `objects`, as they are heard, by the way of real point clouds."""

from __future__ import annotations

from types import SimpleNamespace

from al_questioner.domain import Scene
from al_questioner.messages.clouds import CloudTypes, cloud_of_scene, scene_of_cloud
from al_questioner.protocol.topics import Look

TYPES = CloudTypes(cloud=SimpleNamespace, field=SimpleNamespace, octets=bytes)


def look_of(scene: Scene, stamp: int) -> Look:
    """Return a scene as the nodes hear it, by the way of a real point cloud."""
    return Look(stamp, 'table', lambda known: scene_of_cloud(cloud_of_scene(scene, SimpleNamespace(), TYPES), known))


def broken_look(stamp: int, share: float) -> Look:
    """Return a cloud that cannot be read, or holds what cannot be."""
    width = 3 if share < 0.5 else 0
    cloud = SimpleNamespace(width=width, height=1, fields=[], point_step=0, row_step=0, is_bigendian=False, data=b'')
    return Look(stamp, 'table', lambda known: scene_of_cloud(cloud, known))
