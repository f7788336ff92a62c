// The panels of tools: fields and tables by the names of their objects, and keys as the window system sends them.
#include "plugin/meshlab/meshlab.h"
#include "tests/e2e/driver/commands.h"

#include <QApplication>
#include <QCheckBox>
#include <QComboBox>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QKeyEvent>
#include <QKeySequence>
#include <QLineEdit>
#include <QMainWindow>
#include <QTreeWidget>
#include <QWindow>

// A function of QtGui: the way of keys from the window system.
Q_GUI_EXPORT void qt_handleKeyEvent(QWindow* window, QEvent::Type type, int key, Qt::KeyboardModifiers modifiers,
                                    const QString& text, bool repeated, ushort count);

namespace {

template <class T>
T* named(TestDriver& driver, const QString& name)
{
    for (QWidget* widget : qApp->allWidgets())
        if (widget->objectName() == name)
            if (auto* found = qobject_cast<T*>(widget)) return found;
    driver.fail("no widget '" + name + "' of this kind");
}

// field NAME = VALUE: a field, a choice, or a box to tick (on, off)
Done field(TestDriver& driver, const QString& argument)
{
    const QString name = argument.section('=', 0, 0).trimmed(), value = argument.section('=', 1).trimmed();
    auto* widget = named<QWidget>(driver, name);
    if (auto* choice = qobject_cast<QComboBox*>(widget)) {
        if (choice->findText(value) < 0) driver.fail("'" + name + "' offers no '" + value + "'");
        choice->setCurrentIndex(choice->findText(value));
    } else if (auto* edit = qobject_cast<QLineEdit*>(widget)) {
        if (!edit->isVisible()) driver.fail("'" + name + "' is hidden");
        edit->setText(value);
        QMetaObject::invokeMethod(edit, "editingFinished");
    } else if (auto* tick = qobject_cast<QCheckBox*>(widget)) {
        tick->setChecked(value == "on");
    } else {
        driver.fail("'" + name + "' is of an unknown kind");
    }
    return Done::yes;
}

QTreeWidgetItem* row_of(TestDriver& driver, const QString& argument)
{
    const auto* table = named<QTreeWidget>(driver, argument.section(' ', 0, 0));
    auto* item = table->topLevelItem(argument.section(' ', 1, 1).toInt());
    if (!item) driver.fail("no row " + argument);
    return item;
}

// choose-row NAME ROW
Done choose_row(TestDriver& driver, const QString& argument)
{
    auto* item = row_of(driver, argument);
    item->treeWidget()->setCurrentItem(item);
    return Done::yes;
}

// tick-row NAME ROW on|off
Done tick_row(TestDriver& driver, const QString& argument)
{
    row_of(driver, argument)->setCheckState(0, argument.endsWith(" on") ? Qt::Checked : Qt::Unchecked);
    return Done::yes;
}

// rename-row NAME ROW TEXT: typed into the table
Done rename_row(TestDriver& driver, const QString& argument)
{
    auto* item = row_of(driver, argument);
    QTreeWidget* table = item->treeWidget();
    if (driver.first_try) table->editItem(item, 0);
    auto* editor = table->viewport()->findChild<QLineEdit*>();
    if (!editor) return driver.until(false, "an editor in the table");
    editor->setText(argument.section(' ', 2));
    QKeyEvent enter(QEvent::KeyPress, Qt::Key_Return, Qt::NoModifier);
    qApp->sendEvent(editor, &enter);
    return Done::yes;
}

// key NAME: pressed and released in the view, as the window system sends it: first as an override of a shortcut; if
// nobody takes that, MeshLab's shortcut gets it.
Done key(TestDriver& driver, const QString& name)
{
    int code = QKeySequence::fromString(name)[0];
    const auto modifiers = Qt::KeyboardModifiers(code & int(Qt::KeyboardModifierMask));
    code &= ~int(Qt::KeyboardModifierMask);
    if (code == 0 || code == Qt::Key_unknown) driver.fail("no key '" + name + "'");
    driver.area()->setFocus();
    for (const auto type : {QEvent::KeyPress, QEvent::KeyRelease})
        qt_handleKeyEvent(driver.window()->windowHandle(), type, code, modifiers, QString(), false, 1);
    return Done::yes;
}

// type TEXT: into the open dialog, character by character, as the window system sends them
Done type(TestDriver& driver, const QString& text)
{
    const QWidget* dialog = qApp->activeModalWidget();
    if (!dialog) return driver.until(false, "a dialog");
    for (const QChar c : text)
        for (const auto event : {QEvent::KeyPress, QEvent::KeyRelease})
            qt_handleKeyEvent(dialog->windowHandle(), event, c.toUpper().unicode(), Qt::NoModifier, c, false, 1);
    return Done::yes;
}

// dialog-key NAME: pressed and released in the open dialog, as the window system sends it
Done dialog_key(TestDriver& driver, const QString& name)
{
    const QWidget* dialog = qApp->activeModalWidget();
    if (!dialog) return driver.until(false, "a dialog");
    const int code = QKeySequence::fromString(name)[0];
    for (const auto event : {QEvent::KeyPress, QEvent::KeyRelease})
        if (QWindow* window = dialog == qApp->activeModalWidget() ? dialog->windowHandle() : nullptr)
            qt_handleKeyEvent(window, event, code, Qt::NoModifier, code == Qt::Key_Return ? "\r" : "", false, 1);
    return Done::yes;
}

// key-in NAME KEY: as key, but a widget of a panel has the focus, as after a click on it
Done key_in(TestDriver& driver, const QString& argument)
{
    auto* widget = named<QWidget>(driver, argument.section(' ', 0, 0));
    const int pressed = QKeySequence::fromString(argument.section(' ', 1))[0];
    const auto modifiers = Qt::KeyboardModifiers(pressed & int(Qt::KeyboardModifierMask));
    const int code = pressed & ~int(Qt::KeyboardModifierMask);
    widget->setFocus();
    if (!widget->hasFocus()) driver.fail("'" + argument + "' takes no focus");
    for (const auto type : {QEvent::KeyPress, QEvent::KeyRelease})
        qt_handleKeyEvent(driver.window()->windowHandle(), type, code, modifiers, QString(QChar(code & 0x1f)), false,
                          1);
    return Done::yes;
}

// window-picture NAME FILE: of a window that has a widget of this name
Done window_picture(TestDriver& driver, const QString& argument)
{
    auto* widget = named<QWidget>(driver, argument.section(' ', 0, 0));
    if (!widget->isVisible()) return driver.until(false, "a visible '" + argument + "'");
    if (!widget->window()->grab().save(argument.section(' ', 1))) driver.fail("cannot write " + argument);
    return Done::yes;
}

// expect-no-widget NAME
Done expect_no_widget(TestDriver& driver, const QString& name)
{
    for (const QWidget* widget : qApp->allWidgets())
        if (widget->objectName() == name) driver.fail("there is a widget '" + name + "'");
    return Done::yes;
}

}  // namespace

std::vector<Command> panel_commands()
{
    return {
        {"field", field},

        {"choose-row", choose_row},
        {"tick-row", tick_row},
        {"rename-row", rename_row},
        {"key", key},
        {"type", type},
        {"dialog-key", dialog_key},
        {"key-in", key_in},
        {"window-picture", window_picture},
        {"expect-no-widget", expect_no_widget},
    };
}
