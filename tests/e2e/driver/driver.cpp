#include "tests/e2e/driver/driver.h"

#include "tests/e2e/driver/commands.h"
#include "tests/e2e/driver/paint_witness.h"
#include "tests/e2e/driver/start_over.h"

#include <QApplication>
#include <QFile>
#include <QMainWindow>
#include <QMessageBox>
#include <QScreen>
#include <QSocketNotifier>
#include <QTimer>
#include <QVariantMap>

#include <unistd.h>
#include <cstdio>

namespace {

constexpr int patience_ms = 120000;  // limit of a command that waits; long enough for a busy machine
constexpr int step_ms = 5;           // between two commands, and between two tries of one

std::vector<Command> all_commands()
{
    std::vector<Command> all;
    for (const auto& table : {waiting_commands(), window_commands(), view_commands(), tool_commands(), place_commands(),
                              panel_commands(), table_commands(), output_commands()})
        all.insert(all.end(), table.begin(), table.end());
    return all;
}

}  // namespace

void say(const QString& text)
{
    std::printf("driver: %s\n", qPrintable(text));
    std::fflush(stdout);
}

TestDriver::TestDriver()
{
    if (qEnvironmentVariableIsEmpty("PCM_TEST_DRIVER")) return;
    // With native siblings of the view, MeshLab crashes in Qt's window system when it closes a second document.
    if (qgetenv("PCM_TEST_DRIVER") == "shared") qApp->setAttribute(Qt::AA_DontCreateNativeWidgetSiblings);
    started.start();
    auto* input = new QSocketNotifier(STDIN_FILENO, QSocketNotifier::Read, this);
    connect(input, SIGNAL(activated(int)), this, SLOT(read_input()));
}

TestDriver::~TestDriver() = default;

void TestDriver::fail(const QString& why)
{
    say("FAILED: " + why);
    if (const QWidget* box = qApp->activeModalWidget()) {
        const auto* message_box = qobject_cast<const QMessageBox*>(box);
        say("open dialog: " + box->windowTitle() + (message_box ? ": " + message_box->text() : QString()));
    }
    if (!failure_picture.isEmpty()) QGuiApplication::primaryScreen()->grabWindow(0).save(failure_picture);
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
    // MeshLab clears its overlaid text when it has drawn it; the view's property keeps the state.
    if (!area()) return {};
    const QVariantMap state = area()->property("pcm_state").toMap();
    if (!state["drawing"].toBool()) return "no cloud";
    const int frames = state["smoothing"].toBool() ? 1 : state["frames_averaged"].toInt();
    return QString("%1 points of %2 clouds, %3%4, frame %5 %6")
        .arg(state["points"].toULongLong())
        .arg(state["clouds"].toInt())
        .arg(state["full_resolution"].toBool() ? "complete, full resolution"
             : state["complete"].toBool()      ? "complete"
                                               : "refining")
        .arg(frames > 1 ? QString(", mean of %1").arg(frames) : QString())
        .arg(state["frame"].toInt())
        .arg(state["error"].toString());
}

int TestDriver::frame() const { return area() ? area()->property("pcm_state").toMap()["frame"].toInt() : 0; }

QString TestDriver::log() const
{
    QStringList lines, taken;
    if (MeshDocument* md = document())
        for (const auto& line : md->Log.logStringList()) lines += line.second.split('\n');
    // MeshLab 2025.07 takes the lines out of the log when it shows them.
    if (window())
        for (const QWidget* panel : window()->findChildren<QWidget*>("logPlainTextEdit"))
            taken += panel->property("plainText").toString().split('\n');
    taken.removeAll(QString());
    for (const QString& line : lines) taken.removeOne(line);
    return (taken + lines).join('\n') + '\n';
}

Done TestDriver::until(bool condition, const QString& what)
{
    if (condition) return Done::yes;
    if (waiting.elapsed() > patience_ms)
        fail("timeout while waiting for " + what + "\nstatus:\n" + status() + "\nlog:\n" + log() +
             "\nlast message: " + message);
    return Done::not_yet;
}

void TestDriver::read_input()
{
    char bytes[4096];
    const auto count = ::read(STDIN_FILENO, bytes, sizeof(bytes));
    if (count <= 0) ::_exit(4);  // the tests have ended
    input_.append(bytes, int(count));
    const int end = input_.indexOf('\n');
    if (end < 0) return;
    play(QString::fromLocal8Bit(input_.left(end)));
    input_.remove(0, end + 1);
}

void TestDriver::play(const QString& script)
{
    QFile file(script);
    if (!file.open(QIODevice::ReadOnly)) fail("cannot read the script " + script);
    script_.clear();
    for (const QString& line : QString::fromUtf8(file.readAll()).split('\n'))
        if (!line.trimmed().isEmpty() && !line.startsWith('#')) script_ << line.trimmed();
    next_ = 0;
    waiting.invalidate();
    QTimer::singleShot(step_ms, this, SLOT(step()));
}

// Modal dialogs run their own event loop inside the command that opened them. So the next step is scheduled before a
// command is run, and a command that waits is run again.
void TestDriver::step()
{
    if (next_ >= script_.size()) return;
    if (!beginning && !StartOver::has_begun(*this)) {
        QTimer::singleShot(step_ms, this, SLOT(step()));
        return;
    }
    if (!beginning) beginning = std::make_unique<StartOver>(*this);
    const int mine = next_;
    const QString line = script_[mine];
    first_try = !waiting.isValid();
    if (first_try) {
        waiting.start();
        say(line);
    }
    next_ = mine + 1;
    QTimer::singleShot(step_ms, this, SLOT(step()));
    const auto since_first_try = waiting;
    nested = depth_++ > 0;
    const Done done = run(line.section(' ', 0, 0), line.section(' ', 1).trimmed());
    --depth_;
    if (done == Done::not_yet) {
        next_ = mine;
        waiting = since_first_try;
    } else if (next_ == mine + 1) {
        waiting.invalidate();
        if (next_ == script_.size()) say("played");
    }
}

Done TestDriver::run(const QString& command, const QString& argument)
{
    static const std::vector<Command> commands = all_commands();
    for (const Command& known : commands)
        if (command == known.name) return known.run(*this, argument);
    fail("unknown command " + command);
}
