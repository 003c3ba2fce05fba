"""Stand-ins for the few classes of Cura, Uranium and Qt that the plugin uses, so that its layer for Cura runs in tests.

They have the signatures of Cura 4.13 and keep what they are told. They cannot show that Cura behaves so; README.md says
what was tried with Cura's own modules.
"""

from types import ModuleType, SimpleNamespace
from typing import Any, ClassVar

import numpy as np

MESH = SimpleNamespace(
    corners=np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], np.float32),
    faces=np.array(
        [
            *([0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]),
            *([2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]),
        ],
        np.int32,
    ),
)
"""A unit cube."""


class Mesh:
    """Mesh data of Uranium, with or without indices."""

    def __init__(self, size=(1.0, 1.0, 1.0), *, indexed=True):
        corners = MESH.corners * np.asarray(size, np.float32)
        self.vertices = corners if indexed else corners[MESH.faces].reshape(-1, 3)
        self.indices = MESH.faces if indexed else None

    def getVertices(self):
        return self.vertices

    def getIndices(self):
        return self.indices


class Node:
    """A node of Cura's scene at a position in the scene (y up)."""

    def __init__(self, mesh=None, at=(0.0, 0.0, 0.0), name="", children=(), **decorations):
        self.mesh, self.at, self.name, self.children = mesh, at, name, list(children)
        self.decorations = {"getBuildPlateNumber": 0, "isSliceable": mesh is not None, **decorations}
        self.parent = None
        for child in self.children:
            child.parent = self

    def getChildren(self):
        return self.children

    def getMeshData(self):
        return self.mesh

    def getName(self):
        return self.name

    def getParent(self):
        return self.parent

    def callDecoration(self, name):
        return self.decorations.get(name)

    def getWorldTransformation(self):
        matrix = np.eye(4)
        matrix[:3, 3] = self.at
        return SimpleNamespace(getData=lambda: matrix)


class Signal:
    """A signal that calls its methods at once; like Uranium's it must not be given functions."""

    def __init__(self):
        self.methods = []

    def connect(self, method):
        assert hasattr(method, "__self__"), "Uranium keeps no functions alive"
        self.methods.append(method)

    def emit(self, *arguments):
        for method in self.methods:
            method(*arguments)


class Job:
    """A job that runs when it is started, in the same thread."""

    def __init__(self):
        self.finished, self.progress = Signal(), Signal()
        self.result = self.error = None

    def run(self):
        raise NotImplementedError

    def start(self):
        try:
            self.run()
        except Exception as error:  # noqa: BLE001 - as Uranium's job queue does
            self.error = error
        self.finished.emit(self)

    def setResult(self, result):
        self.result = result

    def getResult(self):
        return self.result

    def getError(self):
        return self.error


class Message:
    """A message that is kept in a list."""

    MessageType = SimpleNamespace(POSITIVE=0, NEUTRAL=1, WARNING=2, ERROR=3)
    shown: ClassVar[list[Any]] = []

    def __init__(
        self,
        text="",
        lifetime=30,
        dismissable=True,
        progress=None,
        title=None,
        parent=None,
        use_inactivity_timer=True,
        message_type=1,
    ):
        self.text, self.progress, self.kind = text, progress, message_type
        self.actions, self.texts, self.hidden = [], [], False
        self.actionTriggered = Signal()

    def addAction(self, action_id, name, icon, description):
        self.actions.append(action_id)

    def setText(self, text):
        self.texts.append(text)

    def setProgress(self, progress):
        self.progress = progress

    def show(self):
        Message.shown.append(self)

    def hide(self):
        self.hidden = True


class Extension:
    """Keeps the entries of the menu."""

    def __init__(self):
        self.menu = {}

    def setMenuName(self, name):
        self.name = name

    def addMenuItem(self, name, function):
        self.menu[name] = function


class GroupedOperation:
    """Removes nodes from their parents when it is pushed."""

    def __init__(self):
        self.operations = []

    def addOperation(self, operation):
        self.operations.append(operation)

    def push(self):
        for operation in self.operations:
            operation.node.parent.children.remove(operation.node)


class RemoveSceneNodeOperation:
    def __init__(self, node):
        self.node = node


class Application:
    """Cura's application with a machine, a scene and preferences."""

    def __init__(self, nodes=(), machine=True):
        self.values, self.read, self.pages = {}, [], []
        self.root = Node(children=nodes)
        settings = {"machine_width": 200, "machine_depth": 100, "machine_height": 150}
        self.machine = (
            SimpleNamespace(getName=lambda: "My printer", getProperty=lambda key, _: settings.get(key))
            if machine
            else None
        )

    def getPreferences(self):
        return SimpleNamespace(
            addPreference=self.values.setdefault, getValue=self.values.get, setValue=self.values.__setitem__
        )

    def getGlobalContainerStack(self):
        return self.machine

    def getBuildVolume(self):
        return SimpleNamespace(getEdgeDisallowedSize=lambda: 3.0)

    def getPrintInformation(self):
        return SimpleNamespace(baseName="my plate")

    def getController(self):
        return SimpleNamespace(getScene=lambda: SimpleNamespace(getRoot=lambda: self.root))

    def getMultiBuildPlateModel(self):
        return SimpleNamespace(activeBuildPlate=0)

    def readLocalFile(self, url, project_mode=None, add_to_recent_files=True):
        self.read.append((url.path, project_mode))

    def createQmlComponent(self, path, context):
        self.pages.append((path, context))
        return SimpleNamespace(show=lambda: None)


class Desktop:
    """Files that were opened with the program of the desktop."""

    opened: ClassVar[list[Any]] = []

    @staticmethod
    def openUrl(url):
        Desktop.opened.append(url.path)


def _decorator(*_types, **_options):
    return lambda function: function


def modules():
    """Return the stand-ins by the names of the modules that they replace."""
    core = {
        "QObject": type("QObject", (), {}),
        "QUrl": SimpleNamespace(fromLocalFile=lambda path: SimpleNamespace(path=path)),
        "pyqtProperty": lambda *_types, **_options: property,
        "pyqtSlot": _decorator,
    }
    contents: dict[str, dict[str, Any]] = {
        "UM": {},
        "UM.Operations": {},
        "UM.Extension": {"Extension": Extension},
        "UM.Job": {"Job": Job},
        "UM.Message": {"Message": Message},
        "UM.Operations.GroupedOperation": {"GroupedOperation": GroupedOperation},
        "UM.Operations.RemoveSceneNodeOperation": {"RemoveSceneNodeOperation": RemoveSceneNodeOperation},
        "PyQt6": {},
        "PyQt6.QtCore": core,
        "PyQt6.QtGui": {"QDesktopServices": Desktop},
    }
    made = {}
    for name, values in contents.items():
        made[name] = ModuleType(name)
        vars(made[name]).update(values)
    return made
