// A plugin that only the tests' MeshLab has: it plays scripts into the running program, as a user would.
//
// If PCM_TEST_DRIVER is set, standard input names scripts, one per line, each when the one before was played. A script
// has one command per line; commands.h says where the commands are. Everything the driver does is printed to standard
// output with the prefix "driver: ", and "driver: played" after a script's last command. A command that fails ends
// MeshLab with exit code 3; the end of the input, without a command `quit` before, ends it with 4. The value "shared"
// is for a MeshLab that starts over after each script, with the command start-over.
#pragma once

#include "tests/e2e/driver/empty_decorator.h"

#include <QByteArray>
#include <QElapsedTimer>
#include <QObject>
#include <QStringList>

#include <memory>

class PaintWitness;
class QMainWindow;
class StartOver;

enum class Done { yes, not_yet };

void say(const QString& text);

class TestDriver : public QObject, public EmptyDecorator {
    Q_OBJECT
    MESHLAB_PLUGIN_IID_EXPORTER(PCM_DECORATE_IID)
    Q_INTERFACES(PCM_DECORATE_INTERFACE)

public:
    TestDriver();
    ~TestDriver() override;

    // For commands that wait: not_yet means that the command is run again soon. Fails when `condition` stays false too
    // long.
    Done until(bool condition, const QString& what);
    [[noreturn]] void fail(const QString& why);

    QMainWindow* window() const;
    GLArea* area() const;  // the visible view; null if there is none
    MeshDocument* document() const;
    QString status() const;  // what the view reports about the clouds that it draws
    int frame() const;       // number of the view's last frame with clouds
    QString log() const;

    bool first_try = true;                             // the current command has not returned not_yet before
    bool nested = false;                               // the current command is run inside another one
    QElapsedTimer waiting;                             // since the first try of the current command
    QElapsedTimer started, opened;                     // since MeshLab's start; since the last command `open`
    int frame_before = 0;                              // the last frame before a command that waits for a new one
    int opening = 0;                                   // files that MeshLab has not finished opening
    QString message;                                   // text of the last message box
    QString failure_picture;                           // file for the screen when a command fails
    Qt::KeyboardModifiers modifiers = Qt::NoModifier;  // modifiers of the mouse events of tools
    std::unique_ptr<PaintWitness> witness;
    std::unique_ptr<StartOver> beginning;  // MeshLab as it was before the first script

private slots:
    void read_input();
    void step();

private:
    void play(const QString& script);
    Done run(const QString& command, const QString& argument);

    QByteArray input_;  // an unfinished line
    QStringList script_;
    int next_ = 0;
    int depth_ = 0;  // number of commands that run inside each other
};
