// The settings of the plugin. It needs only modules of Qt, which Cura 4.13 (Qt 5) and Cura 5 (Qt 6) both contain.
import QtQuick 2.10
import QtQuick.Controls 2.3
import QtQuick.Layouts 1.3
import QtQuick.Window 2.2

Window
{
    id: dialog
    title: "amprep"
    width: 520
    height: form.implicitHeight + 40
    modality: Qt.ApplicationModal

    ColumnLayout
    {
        id: form
        anchors.fill: parent
        anchors.margins: 20
        spacing: 10

        Repeater
        {
            id: settings
            model: manager.rows

            RowLayout
            {
                property string key: modelData.key
                property alias value: field.text
                spacing: 10

                Label
                {
                    text: modelData.label
                    Layout.preferredWidth: 130
                }
                TextField
                {
                    id: field
                    text: modelData.value
                    placeholderText: modelData.hint
                    selectByMouse: true
                    Layout.fillWidth: true
                }
            }
        }
        RowLayout
        {
            Layout.alignment: Qt.AlignRight

            Button
            {
                text: "Cancel"
                onClicked: dialog.close()
            }
            Button
            {
                text: "OK"
                onClicked:
                {
                    for (var row = 0; row < settings.count; row++)
                    {
                        manager.store(settings.itemAt(row).key, settings.itemAt(row).value)
                    }
                    dialog.close()
                }
            }
        }
    }
}
