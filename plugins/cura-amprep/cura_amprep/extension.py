"""The entry in Cura's menu of extensions, the messages, and the change of the scene: the layer that knows Cura."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from UM.Extension import Extension
from UM.Job import Job
from UM.Message import Message
from UM.Operations.GroupedOperation import GroupedOperation
from UM.Operations.RemoveSceneNodeOperation import RemoveSceneNodeOperation

from .bed import Bed, bed_of
from .dialog import SettingsDialog, open_file, url_of
from .outcome import Outcome
from .plate import Model, models_on
from .preparing import Order, file_name, prepare
from .process import Process
from .settings import settings_from

_TITLE = "amprep"
_CANCEL, _REPORT = "cancel", "report"


class PrepareJob(Job):
    """Prepares a plate in a thread of Cura's job queue; its result is an `Outcome`."""

    def __init__(self, order: Order) -> None:
        super().__init__()
        self.order = order
        self.stage = "models"
        self._process = Process()

    def run(self) -> None:
        """Prepare the plate."""
        self.setResult(prepare(self.order, self._process, self._show))

    def cancel(self) -> None:
        """End the process, which then writes no files."""
        self._process.cancel()

    def _show(self, stage: str, fraction: float, message: str) -> None:
        self.stage = f"{stage}: {message}" if message else stage
        self.progress.emit(self, 100.0 * fraction)


class AmprepExtension(Extension):
    """Adds *Prepare plate with amprep* and *Settings* to Cura's menu of extensions."""

    def __init__(self, application: Any) -> None:
        super().__init__()
        self._application = application
        self._dialog = SettingsDialog(application)
        self._job: PrepareJob | None = None
        self._message: Any = None
        self._report: Path | None = None
        self.setMenuName(_TITLE)
        self.addMenuItem("Prepare plate with amprep", self.prepare)
        self.addMenuItem("Settings", self._dialog.show)

    def prepare(self) -> None:
        """Start to prepare the models on the active build plate."""
        if self._job is not None:
            return  # its message shows the progress
        machine = self._application.getGlobalContainerStack()
        if machine is None:
            self._say("Add a printer first.", Message.MessageType.WARNING)
            return
        bed = _bed_of(machine, self._application.getBuildVolume())
        models = self._models(bed)
        if not models:
            self._say("There is no model on the plate.", Message.MessageType.WARNING)
            return
        settings = settings_from(self._application.getPreferences().getValue)
        name = file_name(self._application.getPrintInformation().baseName or models[0].name)
        self._start(PrepareJob(Order(models, bed, settings, name)))

    def _models(self, bed: Bed) -> list[Model]:
        root = self._application.getController().getScene().getRoot()
        plate = self._application.getMultiBuildPlateModel().activeBuildPlate
        return models_on(root, plate, bed.from_scene())

    def _start(self, job: PrepareJob) -> None:
        self._job = job
        self._message = Message(
            "Preparing the plate",
            lifetime=0,
            dismissable=False,
            progress=-1,
            title=_TITLE,
            use_inactivity_timer=False,
        )
        self._message.addAction(_CANCEL, "Cancel", "", "End amprep; nothing is written")
        self._message.actionTriggered.connect(self._cancel)
        self._message.show()
        job.progress.connect(self._show_progress)
        job.finished.connect(self._finish)
        job.start()

    def _cancel(self, _message: Any, action: str) -> None:
        if self._job is not None and action == _CANCEL:
            self._job.cancel()

    def _show_progress(self, job: PrepareJob, percent: float) -> None:
        if self._message is not None:
            self._message.setText(job.stage)
            self._message.setProgress(percent)

    def _finish(self, job: PrepareJob) -> None:
        """Replace the models by the first build, and show the outcome."""
        self._message.hide()
        self._job = self._message = None
        outcome = job.getResult() or Outcome(f"The plugin failed: {job.getError()}")
        if outcome.has_all:
            self._replace(job.order.models, outcome)
        kinds = Message.MessageType
        failed = kinds.NEUTRAL if outcome.is_cancelled else kinds.ERROR
        written = kinds.POSITIVE if outcome.is_good else kinds.WARNING
        self._say(outcome.text, written if outcome.builds else failed, outcome.report)

    def _replace(self, models: Any, outcome: Outcome) -> None:
        """Remove the models, as one step that the user can undo, and open the build.

        Cura's reader of 3MF files places objects from the corner of the bed, and arranges none.
        """
        removal = GroupedOperation()
        for model in models:
            if model.node.getParent() is not None:  # the user may have removed it meanwhile
                removal.addOperation(RemoveSceneNodeOperation(model.node))
        removal.push()
        self._application.readLocalFile(url_of(outcome.builds[0]), "open_as_model")

    def _say(self, text: str, kind: Any, report: Path | None = None) -> None:
        message = Message(text, lifetime=0, title=_TITLE, message_type=kind)
        if report is not None:
            self._report = report
            message.addAction(_REPORT, "Open the report", "", "Show the builds, and what is to be checked")
            # a method, because Cura's signals keep no functions alive
            message.actionTriggered.connect(self._open_report)
        message.show()

    def _open_report(self, _message: Any, action: str) -> None:
        if action == _REPORT and self._report is not None:
            open_file(self._report)


def _bed_of(machine: Any, build_volume: Any) -> Bed:
    def value_of(key: str) -> Any:
        return machine.getProperty(key, "value")

    return bed_of(machine.getName(), value_of, build_volume.getEdgeDisallowedSize() or 0.0)
