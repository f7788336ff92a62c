// A plugin that only the tests' MeshLab has: it plays a script into the running program, as a user would.
//
// PCM_TEST_SCRIPT names the script, which has one command per line; commands.h says where the commands are. Everything
// the driver does is printed to standard output with the prefix "driver: ". A command that fails ends MeshLab with exit
// code 3.
#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QStringList>
#include <QtPlugin>

#include <memory>

class GLArea;
class MeshDocument;
class PaintWitness;
class QMainWindow;

enum class Done { yes, not_yet };

void say(const QString& text);

class TestDriver : public QObject {
    Q_OBJECT
    Q_PLUGIN_METADATA(IID "pcm.TestDriver/1.0")
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
    QElapsedTimer waiting;                             // since the first try of the current command
    QElapsedTimer started, opened;                     // since MeshLab's start; since the last command `open`
    int frame_before = 0;                              // the last frame before a command that waits for a new one
    int opening = 0;                                   // files that MeshLab has not finished opening
    QString message;                                   // text of the last message box
    Qt::KeyboardModifiers modifiers = Qt::NoModifier;  // of the mouse events of tools
    std::unique_ptr<PaintWitness> witness;

private slots:
    void step();

private:
    Done run(const QString& command, const QString& argument);

    QStringList script_;
    int next_ = 0;
};
