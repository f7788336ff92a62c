// Mouse and keys for the tools of point clouds, and what those tools publish.
#include "plugin/meshlab/meshlab.h"
#include "tests/e2e/driver/commands.h"

#include <QApplication>
#include <QJsonDocument>
#include <QJsonObject>
#include <QKeyEvent>
#include <QLabel>
#include <QMainWindow>
#include <QMouseEvent>

namespace {

void send(TestDriver& driver, QEvent::Type type, const QPoint& at, Qt::MouseButton which)
{
    const bool hovers = which == Qt::NoButton;
    const auto button = type == QEvent::MouseMove ? Qt::NoButton : which;
    const auto buttons = hovers || type == QEvent::MouseButtonRelease ? Qt::NoButton : which;
    QMouseEvent event(type, at, driver.area()->mapToGlobal(at), button, buttons, driver.modifiers);
    qApp->sendEvent(driver.area(), &event);
}

// Pixels from two numbers of `text`, which are fractions of the view.
QPoint place_of(const TestDriver& driver, const QString& text, int first = 0)
{
    return QPoint(int(text.section(' ', first, first).toDouble() * driver.area()->width()),
                  int(text.section(' ', first + 1, first + 1).toDouble() * driver.area()->height()));
}

// modifiers Shift+Ctrl | none: of the following clicks and drags of tools
Done set_modifiers(TestDriver& driver, const QString& names)
{
    driver.modifiers = Qt::NoModifier;
    if (names.contains("Shift")) driver.modifiers |= Qt::ShiftModifier;
    if (names.contains("Ctrl")) driver.modifiers |= Qt::ControlModifier;
    if (names.contains("Alt")) driver.modifiers |= Qt::AltModifier;
    return Done::yes;
}

// click X Y, click-right X Y
template <Qt::MouseButton button>
Done click(TestDriver& driver, const QString& argument)
{
    const QPoint at = place_of(driver, argument);
    send(driver, QEvent::MouseButtonPress, at, button);
    send(driver, QEvent::MouseButtonRelease, at, button);
    return Done::yes;
}

// hover X Y: the mouse moves without a button
Done hover(TestDriver& driver, const QString& argument)
{
    send(driver, QEvent::MouseMove, place_of(driver, argument), Qt::NoButton);
    return Done::yes;
}

// draw X0 Y0 X1 Y1 ..., draw-right: drags along a line
template <Qt::MouseButton button>
Done draw(TestDriver& driver, const QString& argument)
{
    constexpr int steps = 8;
    const int corners = argument.count(' ') / 2 + 1;
    QPoint from = place_of(driver, argument);
    send(driver, QEvent::MouseButtonPress, from, button);
    for (int corner = 1; corner < corners; ++corner) {
        const QPoint to = place_of(driver, argument, 2 * corner);
        for (int i = 1; i <= steps; ++i) send(driver, QEvent::MouseMove, from + (to - from) * i / steps, button);
        from = to;
    }
    send(driver, QEvent::MouseButtonRelease, from, button);
    return Done::yes;
}

// escape-in-view: as the window system sends it, first as an override of a shortcut
Done escape_in_view(TestDriver& driver, const QString&)
{
    QKeyEvent asks(QEvent::ShortcutOverride, Qt::Key_Escape, Qt::NoModifier);
    asks.ignore();
    qApp->sendEvent(driver.area(), &asks);
    say(QString("escape %1").arg(asks.isAccepted() ? "taken" : "not taken"));
    return Done::yes;
}

// print-label OBJECT: the text of a label of the window
Done print_label(TestDriver& driver, const QString& name)
{
    const auto* label = driver.window()->findChild<QLabel*>(name);
    if (!label) driver.fail("no label '" + name + "'");
    say("label " + name + ": " + label->text().replace('\n', " | "));
    return Done::yes;
}

// wait-label OBJECT TEXT: until the label has the text in it
Done wait_label(TestDriver& driver, const QString& argument)
{
    const auto* label = driver.window()->findChild<QLabel*>(argument.section(' ', 0, 0));
    const QString text = argument.section(' ', 1);
    return driver.until(label && label->text().contains(text), "the label '" + argument + "'");
}

QJsonValue property_of(const TestDriver& driver, const QString& name)
{
    return QJsonValue::fromVariant(driver.area()->property(qPrintable(name)));
}

// print-property NAME: of the view, as JSON
Done print_property(TestDriver& driver, const QString& name)
{
    const QJsonObject object{{"name", name}, {"value", property_of(driver, name)}};
    say("property " + QJsonDocument(object).toJson(QJsonDocument::Compact));
    return Done::yes;
}

// wait-property NAME TEXT: until the JSON of a property of the view contains the text
Done wait_property(TestDriver& driver, const QString& argument)
{
    const QJsonObject object{{"value", property_of(driver, argument.section(' ', 0, 0))}};
    const QString text = QJsonDocument(object).toJson(QJsonDocument::Compact);
    return driver.until(text.contains(argument.section(' ', 1)), "the property '" + argument + "', now " + text);
}

// forget-property NAME: the next answer of a tool is then the one that a command waits for
Done forget_property(TestDriver& driver, const QString& name)
{
    driver.area()->setProperty(qPrintable(name), {});
    return Done::yes;
}

}  // namespace

std::vector<Command> tool_commands()
{
    return {
        {"modifiers", set_modifiers},
        {"click", click<Qt::LeftButton>},
        {"click-right", click<Qt::RightButton>},
        {"hover", hover},
        {"draw", draw<Qt::LeftButton>},
        {"draw-right", draw<Qt::RightButton>},
        {"escape-in-view", escape_in_view},
        {"print-label", print_label},
        {"wait-label", wait_label},
        {"print-property", print_property},
        {"wait-property", wait_property},
        {"forget-property", forget_property},
    };
}
