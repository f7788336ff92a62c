#include "tests/e2e/driver/start_over.h"

#include "tests/e2e/driver/paint_witness.h"

#include <QApplication>
#include <QDockWidget>
#include <QMainWindow>
#include <QMdiArea>
#include <QMdiSubWindow>
#include <QScreen>
#include <QSettings>
#include <QWindow>

#include <algorithm>

namespace {

RichParameterList& parameters_of(const TestDriver& driver)
{
    return *const_cast<RichParameterList*>(driver.area()->glas.currentGlobalParamSet);
}

QMdiArea& documents_of(const TestDriver& driver) { return *driver.window()->findChild<QMdiArea*>(); }

// The window as large as the screen, which the window manager makes it when it is shown already, and its view in it.
bool fills_the_window(const TestDriver& driver)
{
    constexpr int frame = 8;  // pixels around the view
    const QMainWindow* window = driver.window();
    if (!driver.area() || !window->windowHandle() || !window->windowHandle()->isExposed()) return false;
    if (window->frameGeometry().size() != window->windowHandle()->screen()->availableSize()) return false;
    const QSize beside = documents_of(driver).viewport()->size() - driver.area()->size();
    return std::max(beside.width(), beside.height()) <= frame;
}

// Since 2021.05 MeshLab hides a filter's dialog when it is closed, and one that knows layers that are gone may be seen
// again.
void close_filters(QMainWindow& window)
{
    if (window.metaObject()->indexOfMethod("closeFilterDockDialog()") >= 0)
        QMetaObject::invokeMethod(&window, "closeFilterDockDialog");
    for (QWidget* widget : window.findChildren<QWidget*>()) {
        if (widget->inherits("MeshlabStdDialog")) widget->close();
        if (widget->inherits("FilterDockDialog")) widget->deleteLater();
    }
}

// A document that was changed would ask whether it may be closed.
void close_documents(TestDriver& driver)
{
    for (QMdiSubWindow* document : documents_of(driver).subWindowList()) {
        for (QWidget* widget : document->findChildren<QWidget*>())
            if (widget->inherits("GLArea"))
                for (MeshModel* layer : pcm::host::models_of(*static_cast<GLArea*>(widget)->md()))
                    layer->setMeshModified(false);
        document->close();
    }
}

}  // namespace

bool StartOver::has_begun(const TestDriver& driver) { return driver.window() && fills_the_window(driver); }

StartOver::StartOver(const TestDriver& driver) : parameters_(parameters_of(driver))
{
    const QSettings stored;
    for (const QString& key : stored.allKeys()) settings_[key] = stored.value(key);
}

void StartOver::restore(TestDriver& driver)
{
    QMainWindow* window = driver.window();
    // Our panels are made when they are needed, and found by their names. MeshLab keeps its own.
    for (QDockWidget* panel : window->findChildren<QDockWidget*>())
        if (QByteArray(panel->metaObject()->className()).startsWith("pcm::")) delete panel;
    for (QWidget* log : window->findChildren<QWidget*>("logPlainTextEdit")) QMetaObject::invokeMethod(log, "clear");
    QSettings stored;
    stored.clear();
    for (auto setting = settings_.cbegin(); setting != settings_.cend(); ++setting)
        stored.setValue(setting.key(), setting.value());
    driver.modifiers = Qt::NoModifier;
    driver.message.clear();
    driver.frame_before = 0;
    window->showMaximized();
    QMetaObject::invokeMethod(window, "newProject");
    RichParameterList& parameters = parameters_of(driver);
    for (const RichParameter& first : parameters_)
        if (parameters.hasParameter(first.name())) parameters.setValue(first.name(), first.value());
    QMetaObject::invokeMethod(window, "updateCustomSettings");
}

Done StartOver::run(TestDriver& driver)
{
    if (const QWidget* dialog = qApp->activeModalWidget()) driver.fail("a dialog is left: " + dialog->windowTitle());
    if (driver.first_try) {
        restored_ = false;
        driver.witness.reset();
    }
    if (driver.nested || (driver.document() && driver.document()->isBusy()))
        return driver.until(false, "the end of what was begun");
    if (!restored_ && !documents_of(driver).subWindowList().isEmpty()) {
        close_filters(*driver.window());
        close_documents(driver);
        return driver.until(false, "the end of all documents");
    }
    if (!restored_) restore(driver);
    restored_ = true;
    return driver.until(fills_the_window(driver), "a view that fills the window");
}
