// A plugin that is put into the tests' MeshLab only: it plays a script into the running program, as a user would.
//
// The script is the file that PCM_TEST_SCRIPT names, a command a line; see the table in driver.cpp. Everything the
// driver does is printed to standard output with "driver: " in front. A command that fails ends MeshLab with exit
// code 3.
#pragma once

#include <QElapsedTimer>
#include <QEvent>
#include <QObject>
#include <QPoint>
#include <QStringList>
#include <QtPlugin>

class GLArea;
class MeshDocument;
class QMainWindow;

class TestDriver : public QObject {
    Q_OBJECT
    Q_PLUGIN_METADATA(IID "pcm.TestDriver/1.0")
public:
    TestDriver();

private slots:
    void step();

private:
    enum class Done { yes, not_yet };
    Done run(const QString& command, const QString& argument);
    Done until(bool condition, const QString& what);
    [[noreturn]] void fail(const QString& why);

    QMainWindow* window() const;
    GLArea* area() const;
    MeshDocument* document() const;
    QString status() const;  // what the view says of the clouds that it draws
    int frame() const;       // number of the view's last frame with clouds
    QString log() const;
    void mouse(QEvent::Type type, const QPoint& at, Qt::MouseButton which = Qt::LeftButton);  // to the view
    void key(QEvent::Type type, const QString& name, bool repeated = false);  // to the view, as the window system would
    QWidget* field(const QString& parameter) const;  // the widget of a filter's parameter, by its label

    QStringList script_;
    int next_ = 0;
    QElapsedTimer started_, waiting_, opened_;
    QString shown_;          // text of the last message box
    bool first_try_ = true;  // of the command that runs
    int frame_before_ = 0;
};
