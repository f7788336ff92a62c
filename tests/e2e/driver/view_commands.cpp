#include "plugin/meshlab/meshlab.h"
#include "tests/e2e/driver/commands.h"

#include <QApplication>
#include <QKeyEvent>
#include <QKeySequence>
#include <QMouseEvent>
#include <QWheelEvent>

namespace {

void send_mouse(TestDriver& driver, QEvent::Type type, const QPoint& at, Qt::MouseButton which = Qt::LeftButton)
{
    const auto button = type == QEvent::MouseMove ? Qt::NoButton : which;
    const auto buttons = type == QEvent::MouseButtonRelease ? Qt::NoButton : which;
    QMouseEvent event(type, at, driver.area()->mapToGlobal(at), button, buttons, Qt::NoModifier);
    qApp->sendEvent(driver.area(), &event);
}

// As the window system would send it. `name` is written like a shortcut: W, Shift+W, Alt+Return; Shift alone is the
// key.
Done send_key(TestDriver& driver, QEvent::Type type, const QString& name, bool repeated = false)
{
    int code = name == "Shift" ? int(Qt::Key_Shift) : QKeySequence::fromString(name)[0];
    const auto modifiers = Qt::KeyboardModifiers(code & int(Qt::KeyboardModifierMask));
    code &= ~int(Qt::KeyboardModifierMask);
    if (code == 0 || code == Qt::Key_unknown) driver.fail("no key '" + name + "'");
    QKeyEvent event(type, code, modifiers, QString(), repeated);
    qApp->sendEvent(driver.area(), &event);
    return Done::yes;
}

// The place at two numbers of `text`, from the one at `first`, which are fractions of the view.
QPoint place_of(const TestDriver& driver, const QString& text, int first = 0)
{
    return QPoint(int(text.section(' ', first, first).toDouble() * driver.area()->width()),
                  int(text.section(' ', first + 1, first + 1).toDouble() * driver.area()->height()));
}

// drag X0 Y0 X1 Y1 [STEPS]
Done drag(TestDriver& driver, const QString& argument)
{
    const QPoint from = place_of(driver, argument), to = place_of(driver, argument, 2);
    const QString given = argument.section(' ', 4, 4);
    const int steps = given.isEmpty() ? 10 : given.toInt();
    send_mouse(driver, QEvent::MouseButtonPress, from);
    for (int i = 1; i <= steps; ++i) send_mouse(driver, QEvent::MouseMove, from + (to - from) * i / steps);
    send_mouse(driver, QEvent::MouseButtonRelease, to);
    return Done::yes;
}

// The middle button moves the scene. `argument`: pixels from the view's centre.
Done pan(TestDriver& driver, QEvent::Type type, const QString& argument)
{
    const QPoint centre(driver.area()->width() / 2, driver.area()->height() / 2);
    const QPoint offset(argument.section(' ', 0, 0).toInt(), argument.section(' ', 1, 1).toInt());
    send_mouse(driver, type, centre + offset, Qt::MiddleButton);
    return Done::yes;
}

Done double_click(TestDriver& driver, const QString& argument)
{
    for (const auto type : {QEvent::MouseButtonPress, QEvent::MouseButtonRelease, QEvent::MouseButtonDblClick,
                            QEvent::MouseButtonRelease})
        send_mouse(driver, type, place_of(driver, argument));
    return Done::yes;
}

// As a view may begin, since MeshLab leaves a flag of it uninitialized: the next double click goes to a parameter that
// nothing has asked for.
Done misdirect_double_click(TestDriver& driver, const QString&)
{
    QMetaObject::invokeMethod(driver.area(), "sendPickedPos", Q_ARG(QString, QString()));
    return Done::yes;
}

template <QEvent::Type type>
Done left_button(TestDriver& driver, const QString& argument)
{
    send_mouse(driver, type, place_of(driver, argument));
    return Done::yes;
}

template <QEvent::Type type>
Done middle_button(TestDriver& driver, const QString& argument)
{
    return pan(driver, type, argument);
}

// wheel NOTCHES
Done wheel(TestDriver& driver, const QString& argument)
{
    GLArea* view = driver.area();
    const QPoint centre(view->width() / 2, view->height() / 2);
    QWheelEvent event(centre, view->mapToGlobal(centre), QPoint(), QPoint(0, argument.toInt() * 120), Qt::NoButton,
                      Qt::NoModifier, Qt::NoScrollPhase, false);
    qApp->sendEvent(view, &event);
    return Done::yes;
}

// show-layer ID on|off, in this view
Done show_layer(TestDriver& driver, const QString& argument)
{
    driver.area()->meshVisibilityMap[argument.section(' ', 0, 0).toInt()] = argument.section(' ', 1, 1) == "on";
    driver.area()->update();
    return Done::yes;
}

// move-layer ID X Y Z: sets the translation of its matrix
Done move_layer(TestDriver& driver, const QString& argument)
{
    MeshModel* layer = driver.document()->getMesh(argument.section(' ', 0, 0).toInt());
    if (!layer) driver.fail("no layer " + argument);
    layer->cm.Tr.SetTranslate(argument.section(' ', 1, 1).toFloat(), argument.section(' ', 2, 2).toFloat(),
                              argument.section(' ', 3, 3).toFloat());
    driver.area()->update();
    return Done::yes;
}

// layer-matrix ID M0 ... M15: row by row
Done layer_matrix(TestDriver& driver, const QString& argument)
{
    MeshModel* layer = driver.document()->getMesh(argument.section(' ', 0, 0).toInt());
    if (!layer) driver.fail("no layer " + argument);
    for (int i = 0; i < 16; ++i) layer->cm.Tr.V()[i] = argument.section(' ', i + 1, i + 1).toFloat();
    driver.area()->update();
    return Done::yes;
}

// paint-layer ID FIRST COUNT: makes vertices red as an edit tool does it, which MeshLab does not notice
Done paint_layer(TestDriver& driver, const QString& argument)
{
    MeshModel* layer = driver.document()->getMesh(argument.section(' ', 0, 0).toInt());
    if (!layer) driver.fail("no layer " + argument);
    const int first = argument.section(' ', 1, 1).toInt(), count = argument.section(' ', 2, 2).toInt();
    for (int i = first; i < first + count; ++i) layer->cm.vert[std::size_t(i)].C() = vcg::Color4b(255, 0, 0, 255);
    driver.area()->update();
    return Done::yes;
}

// view-size WIDTH HEIGHT, so that pictures do not depend on fonts and window decoration
Done view_size(TestDriver& driver, const QString& argument)
{
    if (!driver.area()) return driver.until(false, "a view");
    driver.area()->setFixedSize(argument.section(' ', 0, 0).toInt(), argument.section(' ', 1, 1).toInt());
    return Done::yes;
}

Done key_down(TestDriver& driver, const QString& name) { return send_key(driver, QEvent::KeyPress, name); }

Done key_up(TestDriver& driver, const QString& name) { return send_key(driver, QEvent::KeyRelease, name); }

// Window systems send a release before every repeated press.
Done key_repeat(TestDriver& driver, const QString& name)
{
    send_key(driver, QEvent::KeyRelease, name, true);
    return send_key(driver, QEvent::KeyPress, name, true);
}

Done lose_focus(TestDriver& driver, const QString&)
{
    driver.area()->clearFocus();
    return Done::yes;
}

}  // namespace

std::vector<Command> view_commands()
{
    return {
        {"drag", drag},
        {"press-at", left_button<QEvent::MouseButtonPress>},
        {"move-to", left_button<QEvent::MouseMove>},
        {"release-at", left_button<QEvent::MouseButtonRelease>},
        {"double-click", double_click},
        {"misdirect-double-click", misdirect_double_click},
        {"pan-from", middle_button<QEvent::MouseButtonPress>},
        {"pan-to", middle_button<QEvent::MouseMove>},
        {"pan-end", middle_button<QEvent::MouseButtonRelease>},
        {"wheel", wheel},
        {"key-down", key_down},
        {"key-repeat", key_repeat},
        {"key-up", key_up},
        {"lose-focus", lose_focus},
        {"show-layer", show_layer},
        {"move-layer", move_layer},
        {"layer-matrix", layer_matrix},
        {"paint-layer", paint_layer},
        {"view-size", view_size},
    };
}
