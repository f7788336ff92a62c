#include "tests/e2e/driver/driver.h"

#include <common/GLLogStream.h>
#include <common/interfaces.h>
#include <meshlab/glarea.h>

#include <QAbstractButton>
#include <QApplication>
#include <QCheckBox>
#include <QComboBox>
#include <QFile>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QKeyEvent>
#include <QKeySequence>
#include <QLabel>
#include <QLineEdit>
#include <QMainWindow>
#include <QMenu>
#include <QMessageBox>
#include <QScreen>
#include <QStatusBar>
#include <QTimer>
#include <QTreeWidget>
#include <QVariantMap>

#include <unistd.h>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

namespace {

constexpr int patience_ms = 60000;  // of a command that waits for something; a noisy machine is slow, not wrong

void say(const QString& text)
{
    std::printf("driver: %s\n", qPrintable(text));
    std::fflush(stdout);
}

long resident_bytes(const char* key)
{
    QFile file("/proc/self/status");
    if (!file.open(QIODevice::ReadOnly)) return 0;
    for (const QByteArray& line : file.readAll().split('\n'))
        if (line.startsWith(key))
            return line.mid(static_cast<int>(qstrlen(key))).simplified().split(' ')[0].toLong() * 1024;
    return 0;
}

}  // namespace

TestDriver::TestDriver()
{
    const QByteArray name = qgetenv("PCM_TEST_SCRIPT");
    if (name.isEmpty()) return;
    QFile file(QString::fromLocal8Bit(name));
    if (!file.open(QIODevice::ReadOnly)) fail("cannot read the script " + QString(name));
    for (const QString& line : QString::fromUtf8(file.readAll()).split('\n'))
        if (!line.trimmed().isEmpty() && !line.startsWith('#')) script_ << line.trimmed();
    started_.start();
    QTimer::singleShot(50, this, SLOT(step()));
}

void TestDriver::fail(const QString& why)
{
    say("FAILED: " + why);
    if (const QWidget* box = qApp->activeModalWidget()) {
        const auto* message = qobject_cast<const QMessageBox*>(box);
        say("open dialog: " + box->windowTitle() + (message ? ": " + message->text() : QString()));
    }
    const QByteArray picture = qgetenv("PCM_TEST_FAILURE_PICTURE");
    if (!picture.isEmpty()) QGuiApplication::primaryScreen()->grabWindow(0).save(QString::fromLocal8Bit(picture));
    ::_exit(3);
}

QMainWindow* TestDriver::window() const
{
    for (QWidget* widget : qApp->topLevelWidgets())
        if (widget->inherits("MainWindow")) return qobject_cast<QMainWindow*>(widget);
    return nullptr;
}

GLArea* TestDriver::area() const
{
    if (!window()) return nullptr;
    for (QWidget* widget : window()->findChildren<QWidget*>())
        if (widget->inherits("GLArea") && widget->isVisible()) return static_cast<GLArea*>(widget);
    return nullptr;
}

MeshDocument* TestDriver::document() const { return area() ? area()->md() : nullptr; }

QString TestDriver::status() const
{
    // MeshLab empties the overlaid text as soon as it has drawn it; the view keeps what it says.
    if (!area()) return {};
    const QVariantMap state = area()->property("pcm_state").toMap();
    if (!state["drawing"].toBool()) return "no cloud";
    return QString("%1 points of %2 clouds, %3, frame %4 %5")
        .arg(state["points"].toULongLong())
        .arg(state["clouds"].toInt())
        .arg(state["full_resolution"].toBool() ? "complete, full resolution"
             : state["complete"].toBool()      ? "complete"
                                               : "refining")
        .arg(state["frame"].toInt())
        .arg(state["error"].toString());
}

int TestDriver::frame() const { return area() ? area()->property("pcm_state").toMap()["frame"].toInt() : 0; }

QString TestDriver::log() const
{
    QString text;
    if (MeshDocument* md = document())
        for (const auto& line : md->Log.logStringList()) text += line.second + "\n";
    return text;
}

QWidget* TestDriver::field(const QString& parameter) const
{
    // A filter's dialog shows a grid: the parameter's label, and beside it what one types or chooses in. A box to tick
    // has the label itself.
    for (QWidget* widget : qApp->allWidgets())
        if (auto* tick = qobject_cast<QCheckBox*>(widget))
            if (tick->isVisible() && tick->text().startsWith(parameter)) return tick;
    for (QWidget* widget : qApp->allWidgets()) {
        auto* label = qobject_cast<QLabel*>(widget);
        if (!label || !label->isVisible() || !label->text().remove(QRegExp("<[^>]*>")).startsWith(parameter)) continue;
        QWidget* best = nullptr;
        int best_distance = 1 << 30;
        for (QWidget* other : label->window()->findChildren<QWidget*>()) {
            if (!other->isVisible() || !(qobject_cast<QLineEdit*>(other) || qobject_cast<QComboBox*>(other))) continue;
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

void TestDriver::mouse(QEvent::Type type, const QPoint& at, Qt::MouseButton which)
{
    const auto button = type == QEvent::MouseMove ? Qt::NoButton : which;
    const auto buttons = type == QEvent::MouseButtonRelease ? Qt::NoButton : which;
    QMouseEvent event(type, at, area()->mapToGlobal(at), button, buttons, Qt::NoModifier);
    qApp->sendEvent(area(), &event);
}

// `name` as shortcuts are written: W, Shift+W, Alt+Return; Shift alone is the key.
void TestDriver::key(QEvent::Type type, const QString& name, bool repeated)
{
    int code = name == "Shift" ? int(Qt::Key_Shift) : QKeySequence::fromString(name)[0];
    const auto modifiers = Qt::KeyboardModifiers(code & int(Qt::KeyboardModifierMask));
    code &= ~int(Qt::KeyboardModifierMask);
    if (code == 0 || code == Qt::Key_unknown) fail("no key '" + name + "'");
    QKeyEvent event(type, code, modifiers, QString(), repeated);
    qApp->sendEvent(area(), &event);
}

TestDriver::Done TestDriver::until(bool condition, const QString& what)
{
    if (condition) return Done::yes;
    if (waiting_.elapsed() > patience_ms)
        fail("waited in vain for " + what + "\nstatus:\n" + status() + "\nlog:\n" + log() +
             "\nlast message: " + shown_);
    return Done::not_yet;
}

// Modal dialogs run their own event loop inside the command that opened them, so the next step is scheduled before a
// command runs; a command that waits is tried again.
void TestDriver::step()
{
    if (next_ >= script_.size()) return;
    if (!window()) {
        QTimer::singleShot(50, this, SLOT(step()));
        return;
    }
    const int mine = next_;
    const QString line = script_[mine];
    const QString command = line.section(' ', 0, 0), argument = line.section(' ', 1).trimmed();
    first_try_ = !waiting_.isValid();
    if (first_try_) {
        waiting_.start();
        say(line);
    }
    next_ = mine + 1;
    QTimer::singleShot(20, this, SLOT(step()));
    const auto fresh = waiting_;
    if (run(command, argument) == Done::not_yet) {
        next_ = mine;
        waiting_ = fresh;
    } else if (next_ == mine + 1) {
        waiting_.invalidate();
    }
}

TestDriver::Done TestDriver::run(const QString& command, const QString& argument)
{
    if (command == "wait-view") return until(area() != nullptr, "a view");
    if (command == "wait-views") {  // that show a cloud
        int views = 0;
        for (const QWidget* widget : window()->findChildren<QWidget*>())
            views += widget->inherits("GLArea") && widget->property("pcm_state").toMap()["drawing"].toBool();
        return until(views == argument.toInt(), argument + " views");
    }
    if (command == "wait-building") {  // progress shows in the status bar
        const auto* bar = window()->findChild<QStatusBar*>();
        return until(bar && bar->currentMessage().contains("Esc cancels"), "a build");
    }
    if (command == "wait-layers")
        return until(document() && document()->meshList.size() == argument.toInt(), argument + " layers");
    if (command == "wait-status") {
        // Of a frame that begins now: what the last one said may be of another view.
        if (first_try_) {
            frame_before_ = frame();
            if (area()) area()->update();
        }
        return until(frame() > frame_before_ && status().contains(argument), "status '" + argument + "'");
    }
    if (command == "wait-no-status") return until(!status().contains(argument), "no status '" + argument + "'");
    if (command == "wait-log") return until(log().contains(argument), "log '" + argument + "'");
    if (command == "expect-no-dialog") {
        if (QWidget* dialog = qApp->activeModalWidget()) fail("a dialog is open: " + dialog->windowTitle());
        return Done::yes;
    }
    if (command == "pause") return until(waiting_.elapsed() >= argument.toInt(), "the end of a pause");
    if (command == "time") {
        say(QString("time %1 %2 ms").arg(argument).arg(started_.elapsed()));
        return Done::yes;
    }
    if (command == "memory") {
        say(QString("memory %1 now %2 peak %3")
                .arg(argument)
                .arg(resident_bytes("VmRSS:"))
                .arg(resident_bytes("VmHWM:")));
        return Done::yes;
    }
    if (command == "print-status") {
        say("status " + status());
        return Done::yes;
    }
    if (command == "open") {  // queued: an error shows a modal box, and the script must go on to press it
        opened_.start();
        frame_before_ = frame();
        QMetaObject::invokeMethod(window(), "importMeshWithLayerManagement", Qt::QueuedConnection,
                                  Q_ARG(QString, argument));
        return Done::yes;
    }
    if (command == "wait-first-picture") {  // after open
        const bool drawn = frame() > frame_before_ && area()->property("pcm_state").toMap()["points"].toULongLong() > 0;
        if (drawn) say(QString("time first-picture %1 ms").arg(opened_.elapsed()));
        return until(drawn, "a first picture");
    }
    if (command == "export" || command == "export-asking") {  // the current layer; asking for what is to be written
        const bool everything = command == "export";
        QMetaObject::invokeMethod(window(), "saveAs", Qt::QueuedConnection, Q_ARG(QString, argument),
                                  Q_ARG(bool, everything));
        return Done::yes;
    }
    if (command == "print-layers") {
        for (const MeshModel* layer : document()->meshList) {
            QStringList attributes;
            for (const auto& attribute : layer->cm.vert_attr) attributes << QString::fromStdString(attribute._name);
            Box3m box;
            for (const auto& vertex : layer->cm.vert) box.Add(vertex.cP());
            QJsonObject described{{"label", layer->label()},
                                  {"vertices", layer->cm.vn},
                                  {"faces", layer->cm.fn},
                                  {"min", QJsonArray{box.min[0], box.min[1], box.min[2]}},
                                  {"max", QJsonArray{box.max[0], box.max[1], box.max[2]}},
                                  {"colours", layer->hasDataMask(MeshModel::MM_VERTCOLOR)},
                                  {"modified", layer->meshModified()},
                                  {"quality", layer->hasDataMask(MeshModel::MM_VERTQUALITY)},
                                  {"attributes", QJsonArray::fromStringList(attributes)}};
            say("layer " + QJsonDocument(described).toJson(QJsonDocument::Compact));
        }
        return Done::yes;
    }
    if (command == "parameter") {  // parameter Name = value: one of MeshLab's global parameters
        const QString name = argument.section('=', 0, 0).trimmed();
        auto* parameters = const_cast<RichParameterList*>(area()->glas.currentGlobalParamSet);
        if (!parameters->hasParameter(name)) fail("no parameter '" + name + "'");
        const Value& value = parameters->getParameterByName(name).value();
        const double number = argument.section('=', 1).toDouble();
        if (value.isFloat())
            parameters->setValue(name, FloatValue(static_cast<float>(number)));
        else if (value.isEnum())
            parameters->setValue(name, EnumValue(static_cast<int>(number)));
        else if (value.isString())
            parameters->setValue(name, StringValue(argument.section('=', 1).trimmed()));
        else
            parameters->setValue(name, IntValue(static_cast<int>(number)));
        area()->update();
        return Done::yes;
    }
    if (command == "trigger") {
        QList<QAction*> actions = window()->findChildren<QAction*>();
        for (QMenu* menu : window()->findChildren<QMenu*>()) actions += menu->actions();
        for (QAction* action : actions) {
            if (action->text().remove('&') != argument) continue;
            if (!action->isEnabled()) {  // MeshLab brings its menus up to date when one is opened
                QMetaObject::invokeMethod(window(), "updateMenus");
                return until(false, "action '" + argument + "' to be enabled");
            }
            QTimer::singleShot(0, action, SLOT(trigger()));
            return Done::yes;
        }
        fail("no action '" + argument + "'");
    }
    if (command == "press") {  // a button of whatever dialog is open
        for (QWidget* widget : qApp->allWidgets())
            if (auto* button = qobject_cast<QAbstractButton*>(widget))
                if (button->isVisible() && button->text().remove('&') == argument) {
                    if (auto* box = qobject_cast<QMessageBox*>(button->window())) {
                        shown_ = box->text() + " " + box->informativeText();
                        say("message: " + shown_);
                    }
                    QTimer::singleShot(0, button, SLOT(click()));
                    return Done::yes;
                }
        return until(false, "a button '" + argument + "'");
    }
    if (command == "expect-message") {
        if (!shown_.contains(argument)) fail("the message was '" + shown_ + "', not '" + argument + "'");
        return Done::yes;
    }
    if (command == "set") {  // set Parameter label = value
        const QString parameter = argument.section('=', 0, 0).trimmed(), value = argument.section('=', 1).trimmed();
        QWidget* widget = field(parameter);
        if (!widget) return until(false, "a field '" + parameter + "'");
        if (auto* edit = qobject_cast<QLineEdit*>(widget)) {
            edit->setText(value);
            QMetaObject::invokeMethod(edit, "editingFinished");
        } else if (auto* combo = qobject_cast<QComboBox*>(widget)) {
            if (combo->findText(value) < 0) fail("'" + parameter + "' offers no '" + value + "'");
            combo->setCurrentText(value);
        } else if (auto* tick = qobject_cast<QCheckBox*>(widget)) {
            tick->setChecked(value == "on");
        }
        return Done::yes;
    }
    if (command == "drag") {  // drag x0 y0 x1 y1 [steps]: fractions of the view
        const QStringList p = argument.split(' ');
        GLArea* view = area();
        const auto at = [&](int i) {
            return QPoint(int(p[i].toDouble() * view->width()), int(p[i + 1].toDouble() * view->height()));
        };
        const QPoint from = at(0), to = at(2);
        const int steps = p.size() > 4 ? p[4].toInt() : 10;
        mouse(QEvent::MouseButtonPress, from);
        for (int i = 1; i <= steps; ++i) mouse(QEvent::MouseMove, from + (to - from) * i / steps);
        mouse(QEvent::MouseButtonRelease, to);
        return Done::yes;
    }
    // The middle button moves the scene: where it is pressed, step by step, and let go, in pixels from the view's
    // centre.
    if (command == "pan-from" || command == "pan-to" || command == "pan-end") {
        const QPoint centre(area()->width() / 2, area()->height() / 2);
        mouse(command == "pan-from" ? QEvent::MouseButtonPress
              : command == "pan-to" ? QEvent::MouseMove
                                    : QEvent::MouseButtonRelease,
              centre + QPoint(argument.section(' ', 0, 0).toInt(), argument.section(' ', 1, 1).toInt()),
              Qt::MiddleButton);
        return Done::yes;
    }
    if (command == "double-click") {  // fractions of the view
        const QPoint at(int(argument.section(' ', 0, 0).toDouble() * area()->width()),
                        int(argument.section(' ', 1, 1).toDouble() * area()->height()));
        for (const auto type : {QEvent::MouseButtonPress, QEvent::MouseButtonRelease, QEvent::MouseButtonDblClick,
                                QEvent::MouseButtonRelease})
            mouse(type, at);
        return Done::yes;
    }
    if (command == "press-at" || command == "move-to" || command == "release-at") {  // fractions of the view
        const QPoint at(int(argument.section(' ', 0, 0).toDouble() * area()->width()),
                        int(argument.section(' ', 1, 1).toDouble() * area()->height()));
        mouse(command == "press-at"  ? QEvent::MouseButtonPress
              : command == "move-to" ? QEvent::MouseMove
                                     : QEvent::MouseButtonRelease,
              at);
        return Done::yes;
    }
    if (command == "unfold") {  // what the layer panel has folded, as a layer's decorators
        for (QTreeWidget* tree : window()->findChildren<QTreeWidget*>()) tree->expandAll();
        return Done::yes;
    }
    if (command == "show-layer") {  // show-layer ID on|off, in this view
        area()->meshVisibilityMap[argument.section(' ', 0, 0).toInt()] = argument.section(' ', 1, 1) == "on";
        area()->update();
        return Done::yes;
    }
    if (command == "move-layer") {  // move-layer ID X Y Z: its matrix
        MeshModel* layer = document()->getMesh(argument.section(' ', 0, 0).toInt());
        if (!layer) fail("no layer " + argument);
        layer->cm.Tr.SetTranslate(argument.section(' ', 1, 1).toFloat(), argument.section(' ', 2, 2).toFloat(),
                                  argument.section(' ', 3, 3).toFloat());
        area()->update();
        return Done::yes;
    }
    if (command == "key-down" || command == "key-repeat" || command == "key-up") {
        // Window systems send a release before every repeated press.
        if (command == "key-repeat") key(QEvent::KeyRelease, argument, true);
        key(command == "key-up" ? QEvent::KeyRelease : QEvent::KeyPress, argument, command == "key-repeat");
        return Done::yes;
    }
    if (command == "lose-focus") {
        area()->clearFocus();
        return Done::yes;
    }
    if (command == "wait-moving" || command == "wait-standing") {  // the first-person tool
        const bool moving = area()->property("pcm_first_person").toMap()["moving"].toBool();
        return until(moving == (command == "wait-moving"), command);
    }
    if (command == "wait-full-screen")
        return until(window()->isFullScreen() == (argument == "on"), "full screen " + argument);
    if (command == "print-camera") {  // of MeshLab, in the document's coordinates; argument: a name for it
        const vcg::Similarityf& track = area()->trackball.track;
        const auto [distance, orthographic] = area()->fov <= 5
                                                  ? std::pair(8.0, true)
                                                  : std::pair(1.75 / std::tan(double(area()->fov) * M_PI / 360), false);
        const auto to_scene = [&](const vcg::Point3f& p) {
            const vcg::Point3f q = track.rot.Inverse().Rotate(p) / track.sca - track.tra;
            return QJsonArray{q[0], q[1], q[2]};
        };
        const QVariantMap walk = area()->property("pcm_first_person").toMap();
        const QJsonObject described{{"name", argument},
                                    {"eye", to_scene(vcg::Point3f(0, 0, float(distance)))},
                                    {"centre", to_scene(vcg::Point3f(0, 0, 0))},
                                    {"above", to_scene(vcg::Point3f(0, 1, 0))},
                                    {"scale", track.sca},
                                    {"near", area()->nearPlane},
                                    {"orthographic", orthographic},
                                    {"keys", walk["keys"].toInt()},
                                    {"moving", walk["moving"].toBool()},
                                    {"factor", walk["factor"].toDouble()},
                                    {"roll", walk["roll"].toDouble()},
                                    {"reach", walk["reach"].toDouble()},
                                    {"reach_error", walk["reach_error"].toDouble()},
                                    {"window", QJsonArray{window()->width(), window()->height()}},
                                    {"full_screen", window()->isFullScreen()}};
        say("camera " + QJsonDocument(described).toJson(QJsonDocument::Compact));
        return Done::yes;
    }
    if (command == "print-log") {
        say("log " + log().replace('\n', " | "));
        return Done::yes;
    }
    if (command == "escape") {
        QKeyEvent key(QEvent::KeyPress, Qt::Key_Escape, Qt::NoModifier);
        qApp->sendEvent(window(), &key);
        return Done::yes;
    }
    if (command == "wheel") {
        GLArea* view = area();
        const QPoint centre(view->width() / 2, view->height() / 2);
        QWheelEvent event(centre, view->mapToGlobal(centre), QPoint(), QPoint(0, argument.toInt() * 120), Qt::NoButton,
                          Qt::NoModifier, Qt::NoScrollPhase, false);
        qApp->sendEvent(view, &event);
        return Done::yes;
    }
    if (command == "view-size") {  // so that pictures do not depend on fonts and window decoration
        if (!area()) return until(false, "a view");
        area()->setFixedSize(argument.section(' ', 0, 0).toInt(), argument.section(' ', 1, 1).toInt());
        return Done::yes;
    }
    if (command == "picture") {  // what the view shows, without MeshLab's texts
        GLArea* view = area();
        const bool texts = view->infoAreaVisible, ball = view->isTrackBallVisible();
        view->infoAreaVisible = false;
        view->showTrackBall(false);
        view->repaint();  // a grab does not draw, it reads what was drawn last
        const QImage image = view->grabFrameBuffer();
        view->infoAreaVisible = texts;
        view->showTrackBall(ball);
        if (!image.save(argument)) fail("cannot write " + argument);
        say(QString("picture %1 %2x%3, %4").arg(argument).arg(image.width()).arg(image.height()).arg(status()));
        return Done::yes;
    }
    if (command == "screen") {
        if (!QGuiApplication::primaryScreen()->grabWindow(0).save(argument)) fail("cannot write " + argument);
        return Done::yes;
    }
    if (command == "quit") {  // as the user does it
        QTimer::singleShot(0, window(), SLOT(close()));
        return Done::yes;
    }
    fail("unknown command " + command);
}
