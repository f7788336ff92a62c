#include "plugin/meshlab/meshlab.h"
#include "tests/e2e/driver/commands.h"
#include "tests/e2e/driver/start_over.h"
#include "tests/plugin/choice.h"

#include <QAbstractButton>
#include <QAction>
#include <QApplication>
#include <QCheckBox>
#include <QColorDialog>
#include <QComboBox>
#include <QDir>
#include <QDockWidget>
#include <QDoubleSpinBox>
#include <QFileDialog>
#include <QKeyEvent>
#include <QLabel>
#include <QLineEdit>
#include <QMainWindow>
#include <QMenu>
#include <QMessageBox>
#include <QPointer>
#include <QTimer>
#include <QTreeWidget>

#include <cstdlib>

namespace {

// The widget of a filter's parameter. A filter's dialog shows a grid: the parameter's label, and to the right of it an
// edit or a combo box. A check box has the label itself.
QWidget* field(const QString& parameter)
{
    for (QWidget* widget : qApp->allWidgets())
        if (auto* tick = qobject_cast<QCheckBox*>(widget))
            if (tick->isVisible() && tick->text().startsWith(parameter)) return tick;
    for (QWidget* widget : qApp->allWidgets()) {
        auto* label = qobject_cast<QLabel*>(widget);
        if (!label || !label->isVisible() || !label->text().remove(QRegExp("<[^>]*>")).startsWith(parameter)) continue;
        QWidget* best = nullptr;
        int best_distance = 1 << 30;
        for (QWidget* other : label->window()->findChildren<QWidget*>()) {
            const auto* tick = qobject_cast<QCheckBox*>(other);  // since 2021.05 with a label like the others
            const bool is_tick = tick && tick->text().isEmpty();
            if (!other->isVisible() || !(is_tick || qobject_cast<QLineEdit*>(other) || qobject_cast<QComboBox*>(other)))
                continue;
            const QPoint d =
                other->mapToGlobal(QPoint(0, other->height() / 2)) - label->mapToGlobal(QPoint(0, label->height() / 2));
            if (d.x() < 0 || std::abs(d.y()) > label->height()) continue;
            if (d.x() < best_distance) {
                best_distance = d.x();
                best = other;
            }
        }
        if (best) return best;
    }
    return nullptr;
}

// open FILE. Queued, because an error shows a modal box, which a later command is to press.
Done open(TestDriver& driver, const QString& argument)
{
    driver.opened.start();
    driver.frame_before = driver.frame();
    ++driver.opening;
    QTimer::singleShot(0, driver.window(), [&driver, argument] {
        QMetaObject::invokeMethod(driver.window(), "importMeshWithLayerManagement", Qt::DirectConnection,
                                  Q_ARG(QString, argument));
        --driver.opening;
    });
    return Done::yes;
}

// open-project FILE
Done open_project(TestDriver& driver, const QString& file)
{
    QMetaObject::invokeMethod(driver.window(), "openProject", Qt::QueuedConnection, Q_ARG(QString, file));
    return Done::yes;
}

// Saves the current layer, with or without the dialog about what is to be written.
void save(TestDriver& driver, const QString& file, bool everything)
{
    QMetaObject::invokeMethod(driver.window(), "saveAs", Qt::QueuedConnection, Q_ARG(QString, file),
                              Q_ARG(bool, everything));
}

// trigger TEXT: an action of a menu.
Done trigger(TestDriver& driver, const QString& argument)
{
    QList<QAction*> actions = driver.window()->findChildren<QAction*>();
    for (QMenu* menu : driver.window()->findChildren<QMenu*>()) actions += menu->actions();
    for (QAction* action : actions) {
        if (action->text().remove('&') != argument || action->menu()) continue;
        if (!action->isEnabled()) {  // MeshLab updates its menus when one is opened
            QMetaObject::invokeMethod(driver.window(), "updateMenus");
            return driver.until(false, "action '" + argument + "' to be enabled");
        }
        QTimer::singleShot(0, action, SLOT(trigger()));
        return Done::yes;
    }
    driver.fail("no action '" + argument + "'");
}

// press TEXT: a button of the open dialog. A button whose click is still to come is not pressed again: that is meant
// for another dialog's, which the click opens.
Done press(TestDriver& driver, const QString& argument)
{
    constexpr const char* clicked = "pcm-click-to-come";
    for (QWidget* widget : qApp->allWidgets()) {
        auto* button = qobject_cast<QAbstractButton*>(widget);
        if (!button || !button->isVisible() || button->text().remove('&') != argument) continue;
        if (qApp->activeModalWidget() && button->window() != qApp->activeModalWidget()) continue;
        if (button->property(clicked).toBool()) continue;
        if (auto* box = qobject_cast<QMessageBox*>(button->window())) {
            driver.message = box->windowTitle() + ": " + box->text() + " " + box->informativeText();
            say("message: " + driver.message);
        }
        button->setProperty(clicked, true);
        QTimer::singleShot(0, button, [button] {
            button->setProperty(clicked, false);
            button->click();
        });
        return Done::yes;
    }
    return driver.until(false, "a button '" + argument + "'");
}

// answer TEXT: a button of a message, which is waited for
Done answer(TestDriver& driver, const QString& button)
{
    if (!qobject_cast<QMessageBox*>(qApp->activeModalWidget())) return driver.until(false, "a message");
    return press(driver, button);
}

// set LABEL = VALUE: a parameter in the open dialog.
Done set(TestDriver& driver, const QString& argument)
{
    const QString parameter = argument.section('=', 0, 0).trimmed(), value = argument.section('=', 1).trimmed();
    QWidget* widget = field(parameter);
    if (!widget) return driver.until(false, "a field '" + parameter + "'");
    if (auto* edit = qobject_cast<QLineEdit*>(widget)) {
        edit->setText(value);
        QMetaObject::invokeMethod(edit, "textEdited", Q_ARG(QString, value));
        QMetaObject::invokeMethod(edit, "editingFinished");
    } else if (auto* combo = qobject_cast<QComboBox*>(widget)) {
        if (combo->findText(value) < 0) driver.fail("'" + parameter + "' offers no '" + value + "'");
        combo->setCurrentText(value);
    } else if (auto* tick = qobject_cast<QCheckBox*>(widget)) {
        tick->setChecked(value == "on");
    }
    return Done::yes;
}

// parameter NAME = VALUE: one of MeshLab's global parameters.
Done parameter(TestDriver& driver, const QString& argument)
{
    const QString name = argument.section('=', 0, 0).trimmed();
    auto* parameters = const_cast<RichParameterList*>(driver.area()->glas.currentGlobalParamSet);
    if (!parameters->hasParameter(name)) driver.fail("no parameter '" + name + "'");
    const Value& value = parameters->getParameterByName(name).value();
    const double number = argument.section('=', 1).toDouble();
    if (value.isFloat())
        parameters->setValue(name, FloatValue(static_cast<float>(number)));
    else if (const RichEnum* choice = pcm::test::find_choice(*parameters, name))
        pcm::test::choose(*parameters, *choice, static_cast<int>(number));
    else if (value.isBool())
        parameters->setValue(name, BoolValue(number != 0));
    else if (value.isString())
        parameters->setValue(name, StringValue(argument.section('=', 1).trimmed()));
    else
        parameters->setValue(name, IntValue(static_cast<int>(number)));
    driver.area()->update();
    return Done::yes;
}

// field-button LABEL = TEXT: a button in a field of the open dialog
Done field_button(TestDriver& driver, const QString& argument)
{
    QWidget* widget = field(argument.section('=', 0, 0).trimmed());
    if (widget)
        for (QAction* action : widget->actions())
            if (action->text() == argument.section('=', 1).trimmed()) {
                QTimer::singleShot(0, action, SLOT(trigger()));
                return Done::yes;
            }
    return driver.until(false, "a button '" + argument + "'");
}

// print-field LABEL: the text of a field of the open dialog
Done print_field(TestDriver& driver, const QString& argument)
{
    QWidget* widget = field(argument);
    const auto* edit = qobject_cast<QLineEdit*>(widget);
    const auto* choice = qobject_cast<QComboBox*>(widget);
    if (!edit && !choice) driver.fail("no field '" + argument + "'");
    say("field " + argument + ": " + (edit ? edit->text() : choice->currentText()));
    return Done::yes;
}

// pick PATH [; PATH...]: in the open dialog for files; nothing keeps the name that it proposes
Done pick(TestDriver& driver, const QString& argument)
{
    static QPointer<QFileDialog> picked;
    static bool waits_for_end = false;
    auto* dialog = qobject_cast<QFileDialog*>(qApp->activeModalWidget());
    if (waits_for_end) {
        waits_for_end = picked && picked == dialog;
        return driver.until(!waits_for_end, "the end of a dialog for files");
    }
    auto* name = dialog ? dialog->findChild<QLineEdit*>("fileNameEdit") : nullptr;
    if (!name) return driver.until(false, "a dialog for files");
    driver.message = dialog->windowTitle() + " " + dialog->selectedNameFilter() + " " + name->text();
    say("file dialog: " + driver.message);
    QStringList names;
    for (const QString& path : argument.split("; ", Qt::SkipEmptyParts)) names << path.trimmed();
    if (!names.empty()) name->setText(names.size() == 1 ? names.first() : '"' + names.join("\" \"") + '"');
    picked = dialog;
    waits_for_end = true;
    QMetaObject::invokeMethod(dialog, "accept", Qt::QueuedConnection);
    return Done::not_yet;
}

// close-dialog: the open one, as Esc does
Done close_dialog(TestDriver& driver, const QString&)
{
    auto* dialog = qobject_cast<QDialog*>(qApp->activeModalWidget());
    if (!dialog) return driver.until(false, "a dialog");
    QMetaObject::invokeMethod(dialog, "reject", Qt::QueuedConnection);
    return Done::yes;
}

// choose-colour #RRGGBB | cancel: in the open dialog for colours
Done choose_colour(TestDriver& driver, const QString& colour)
{
    auto* dialog = qobject_cast<QColorDialog*>(qApp->activeModalWidget());
    if (!dialog) return driver.until(false, "a dialog for colours");
    if (colour != "cancel") dialog->setCurrentColor(QColor(colour));
    QMetaObject::invokeMethod(dialog, colour == "cancel" ? "reject" : "accept", Qt::QueuedConnection);
    return Done::yes;
}

// panel NAME = VALUE: a setting in the panel "Point Cloud"; NAMEOn is the check box of a number that can be off.
Done panel(TestDriver& driver, const QString& argument)
{
    const QString name = "MeshLab::PointCloud::" + argument.section('=', 0, 0).trimmed();
    const QString value = argument.section('=', 1).trimmed();
    const auto* dock = driver.window()->findChild<QDockWidget*>("PointCloudDock");
    auto* widget = dock ? dock->findChild<QWidget*>(name) : nullptr;
    if (!widget || !dock->isVisible()) driver.fail("the panel has no '" + name + "'");
    if (auto* choice = qobject_cast<QComboBox*>(widget)) {
        if (choice->findText(value) < 0) driver.fail("'" + name + "' offers no '" + value + "'");
        choice->setCurrentText(value);
    } else if (auto* number = qobject_cast<QDoubleSpinBox*>(widget)) {
        number->setValue(value.toDouble());
    } else if (auto* tick = qobject_cast<QCheckBox*>(widget)) {
        if (tick->isChecked() != (value == "on")) tick->click();
    } else {
        driver.fail("'" + name + "' is of an unknown kind");
    }
    return Done::yes;
}

// print-docks: how wide each panel of the window is at least, pixels
Done print_docks(TestDriver& driver, const QString&)
{
    for (const QDockWidget* dock : driver.window()->findChildren<QDockWidget*>())
        say(QString("dock %1 %2").arg(dock->objectName()).arg(dock->minimumSizeHint().width()));
    return Done::yes;
}

// print-menu TEXT: the entries of a menu of the window and of its submenus, one line each: "Open and Build > Open..."
void print_entries(const QMenu& menu, const QString& path)
{
    for (const QAction* action : menu.actions()) {
        if (action->isSeparator()) continue;
        const QString text = path + action->text().remove('&');
        action->menu() ? print_entries(*action->menu(), text + " > ") : say("menu " + text);
    }
}

Done print_menu(TestDriver& driver, const QString& text)
{
    for (QMenu* menu : driver.window()->findChildren<QMenu*>())
        if (menu->title().remove('&') == text) return print_entries(*menu, {}), Done::yes;
    return driver.until(false, "a menu '" + text + "'");
}

// print-ticks: the visible boxes to tick of the open dialog that are enabled
Done print_ticks(TestDriver& driver, const QString&)
{
    const QWidget* dialog = qApp->activeModalWidget();
    if (!dialog) return driver.until(false, "a dialog");
    QStringList names;
    for (const QCheckBox* tick : dialog->findChildren<QCheckBox*>())
        if (tick->isVisible() && tick->isEnabled()) names << (tick->objectName() + ":" + tick->text());
    names.sort();
    say("ticks " + names.join(", "));
    return Done::yes;
}

// Opens all folded items of the layer panel, such as the parameters of decorators.
Done unfold(TestDriver& driver, const QString&)
{
    for (QTreeWidget* tree : driver.window()->findChildren<QTreeWidget*>()) tree->expandAll();
    return Done::yes;
}

Done escape(TestDriver& driver, const QString&)
{
    QKeyEvent key(QEvent::KeyPress, Qt::Key_Escape, Qt::NoModifier);
    qApp->sendEvent(driver.window(), &key);
    return Done::yes;
}

// folder PATH: where MeshLab writes snapshots
Done folder(TestDriver& driver, const QString& path)
{
    if (!QDir::setCurrent(path)) driver.fail("no folder '" + path + "'");
    return Done::yes;
}

// As the user does it, by closing the window.
Done quit(TestDriver& driver, const QString&)
{
    QTimer::singleShot(0, driver.window(), SLOT(close()));
    return Done::yes;
}

}  // namespace

std::vector<Command> window_commands()
{
    return {
        {"open", open},
        {"open-project", open_project},
        {"export", [](TestDriver& driver, const QString& file) { return save(driver, file, true), Done::yes; }},
        {"export-asking", [](TestDriver& driver, const QString& file) { return save(driver, file, false), Done::yes; }},
        {"trigger", trigger},
        {"press", press},
        {"answer", answer},
        {"set", set},
        {"parameter", parameter},
        {"field-button", field_button},
        {"print-field", print_field},
        {"pick", pick},
        {"close-dialog", close_dialog},
        {"choose-colour", choose_colour},
        {"panel", panel},
        {"print-docks", print_docks},
        {"print-menu", print_menu},
        {"print-ticks", print_ticks},
        {"unfold", unfold},
        {"escape", escape},
        {"folder", folder},
        {"failure-picture",
         [](TestDriver& driver, const QString& file) { return driver.failure_picture = file, Done::yes; }},
        {"start-over", [](TestDriver& driver, const QString&) { return driver.beginning->run(driver); }},
        {"quit", quit},
    };
}
