#include "plugin/meshlab/meshlab.h"
#include "tests/e2e/driver/commands.h"

#include <QApplication>
#include <QFile>
#include <QMainWindow>
#include <QStatusBar>
#include <QVariantMap>

namespace {

// Counts views that show a cloud.
Done wait_views(TestDriver& driver, const QString& argument)
{
    int views = 0;
    for (const QWidget* widget : driver.window()->findChildren<QWidget*>())
        views += widget->inherits("GLArea") && widget->property("pcm_state").toMap()["drawing"].toBool();
    return driver.until(views == argument.toInt(), argument + " views");
}

// The status bar shows the progress of a build.
Done wait_building(TestDriver& driver, const QString&)
{
    const auto* bar = driver.window()->findChild<QStatusBar*>();
    return driver.until(bar && bar->currentMessage().contains("Esc cancels"), "a build");
}

Done wait_layers(TestDriver& driver, const QString& argument)
{
    // While MeshLab opens a file it handles events, so scripts run: the layer exists before it is complete.
    MeshDocument* document = driver.document();
    const bool complete = driver.opening == 0 && document && !document->isBusy();
    return driver.until(complete && int(pcm::host::models_of(*document).size()) == argument.toInt(),
                        argument + " layers");
}

// The status of a frame that starts now: that of the last frame may be about another view.
Done wait_status(TestDriver& driver, const QString& argument)
{
    if (driver.first_try) {
        driver.frame_before = driver.frame();
        if (driver.area()) driver.area()->update();
    }
    return driver.until(driver.frame() > driver.frame_before && driver.status().contains(argument),
                        "status '" + argument + "'");
}

Done wait_no_status(TestDriver& driver, const QString& argument)
{
    return driver.until(!driver.status().contains(argument), "no status '" + argument + "'");
}

Done wait_log(TestDriver& driver, const QString& argument)
{
    return driver.until(driver.log().contains(argument), "log '" + argument + "'");
}

// wait-notice TEXT: what the view says in red about samples; "none" for nothing.
Done wait_notice(TestDriver& driver, const QString& argument)
{
    if (driver.first_try && driver.area()) driver.area()->update();
    const QString notice = driver.area() ? driver.area()->property("pcm_sample_notice").toString() : QString();
    return driver.until(argument == "none" ? notice.isEmpty() : notice.contains(argument), "notice '" + argument + "'");
}

// wait-file PATH: until a file is there
Done wait_file(TestDriver& driver, const QString& path)
{
    return driver.until(QFile::exists(path), "the file '" + path + "'");
}

// After the command `open`.
Done wait_first_picture(TestDriver& driver, const QString&)
{
    const bool drawn = driver.frame() > driver.frame_before &&
                       driver.area()->property("pcm_state").toMap()["points"].toULongLong() > 0;
    if (drawn) say(QString("time first-picture %1 ms").arg(driver.opened.elapsed()));
    return driver.until(drawn, "a first picture");
}

bool walks(const TestDriver& driver) { return driver.area()->property("pcm_first_person").toMap()["moving"].toBool(); }

Done wait_full_screen(TestDriver& driver, const QString& argument)
{
    return driver.until(driver.window()->isFullScreen() == (argument == "on"), "full screen " + argument);
}

Done expect_no_dialog(TestDriver& driver, const QString&)
{
    if (QWidget* dialog = qApp->activeModalWidget()) driver.fail("a dialog is open: " + dialog->windowTitle());
    return Done::yes;
}

Done expect_message(TestDriver& driver, const QString& argument)
{
    if (!driver.message.contains(argument))
        driver.fail("the message was '" + driver.message + "', not '" + argument + "'");
    return Done::yes;
}

}  // namespace

std::vector<Command> waiting_commands()
{
    return {
        {"wait-view",
         [](TestDriver& driver, const QString&) { return driver.until(driver.area() != nullptr, "a view"); }},
        {"wait-views", wait_views},
        {"wait-building", wait_building},
        {"wait-layers", wait_layers},
        {"wait-status", wait_status},
        {"wait-no-status", wait_no_status},
        {"wait-log", wait_log},
        {"wait-notice", wait_notice},
        {"wait-file", wait_file},
        {"wait-first-picture", wait_first_picture},
        // The first-person tool.
        {"wait-moving", [](TestDriver& driver, const QString&) { return driver.until(walks(driver), "movement"); }},
        {"wait-standing",
         [](TestDriver& driver, const QString&) { return driver.until(!walks(driver), "standstill"); }},
        {"wait-full-screen", wait_full_screen},
        {"pause",
         [](TestDriver& driver, const QString& argument) {
             return driver.until(driver.waiting.elapsed() >= argument.toInt(), "the end of a pause");
         }},
        {"expect-no-dialog", expect_no_dialog},
        {"expect-message", expect_message},
    };
}
