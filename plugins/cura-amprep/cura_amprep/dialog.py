"""The settings dialog: hands rows of the settings to the page in QML, and stores what the user enters."""

from __future__ import annotations

from pathlib import Path
from typing import Any

try:
    from PyQt6.QtCore import QObject, QUrl, pyqtProperty, pyqtSlot
    from PyQt6.QtGui import QDesktopServices
except ImportError:  # Cura 4
    from PyQt5.QtCore import QObject, QUrl, pyqtProperty, pyqtSlot
    from PyQt5.QtGui import QDesktopServices

from .settings import DEFAULTS, PREFIX, rows_of, settings_from

PAGE = Path(__file__).with_name("SettingsDialog.qml")


class SettingsDialog(QObject):
    """What the page in QML calls ``manager``."""

    def __init__(self, application: Any) -> None:
        super().__init__()
        self._application = application
        self._window: Any = None
        for key, default in DEFAULTS.items():
            application.getPreferences().addPreference(PREFIX + key, default)

    def show(self) -> None:
        """Show the dialog with the present settings."""
        self._window = self._application.createQmlComponent(str(PAGE), {"manager": self})
        if self._window is not None:
            self._window.show()

    @pyqtProperty("QVariantList", constant=True)
    def rows(self) -> list[dict[str, str]]:
        """The rows: key, label, hint and value."""
        return rows_of(settings_from(self._application.getPreferences().getValue))

    @pyqtSlot(str, str)
    def store(self, key: str, value: str) -> None:
        """Store the value of a setting."""
        if key in DEFAULTS:
            self._application.getPreferences().setValue(PREFIX + key, value.strip())


def url_of(path: Path) -> Any:
    """Return the address of a local file as Qt's type."""
    return QUrl.fromLocalFile(str(path))


def open_file(path: Path) -> None:
    """Open a file with the program that the desktop chooses."""
    QDesktopServices.openUrl(url_of(path))
