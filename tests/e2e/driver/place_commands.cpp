// Clicks at places of the scene, and the table of a panel as text.
#include "plugin/meshlab/meshlab.h"
#include "tests/e2e/driver/commands.h"

#include <QApplication>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QLineEdit>
#include <QMainWindow>
#include <QMouseEvent>
#include <QTableWidget>

#include <cmath>

namespace {

// The pixel of a place in MeshLab's coordinates, as MeshLab's camera projects it (a perspective view).
QPoint pixel_of(TestDriver& driver, const vcg::Point3f& place)
{
    const GLArea* view = driver.area();
    if (view->fov <= 5) driver.fail("the view is orthographic");
    const double half = std::tan(double(view->fov) * M_PI / 360);
    const vcg::Similarityf& track = view->trackball.track;
    const vcg::Point3f q = track.rot.Rotate(place + track.tra) * track.sca;
    const double away = 1.75 / half - double(q[2]);
    const double x = double(q[0]) / (away * half) * view->height() / view->width(), y = double(q[1]) / (away * half);
    const QPoint pixel(int((x + 1) / 2 * view->width()), int((1 - y) / 2 * view->height()));
    if (!view->rect().contains(pixel)) driver.fail("the place is out of view");
    return pixel;
}

// click-place X Y Z: in MeshLab's coordinates
Done click_place(TestDriver& driver, const QString& argument)
{
    const auto number = [&](int i) { return argument.section(' ', i, i).toFloat(); };
    const QPoint at = pixel_of(driver, {number(0), number(1), number(2)});
    for (const auto type : {QEvent::MouseButtonPress, QEvent::MouseButtonRelease}) {
        QMouseEvent event(type, at, driver.area()->mapToGlobal(at), Qt::LeftButton,
                          type == QEvent::MouseButtonPress ? Qt::LeftButton : Qt::NoButton, driver.modifiers);
        qApp->sendEvent(driver.area(), &event);
    }
    return Done::yes;
}

// click-cell TABLE ROW COLUMN: clicks into a cell of a table of the window
Done click_cell(TestDriver& driver, const QString& argument)
{
    auto* table = driver.window()->findChild<QTableWidget*>(argument.section(' ', 0, 0));
    if (!table) driver.fail("no table '" + argument + "'");
    QTableWidgetItem* item = table->item(argument.section(' ', 1, 1).toInt(), argument.section(' ', 2, 2).toInt());
    if (!item) driver.fail("no cell '" + argument + "'");
    const QPoint at = table->visualItemRect(item).center();
    for (const auto type : {QEvent::MouseButtonPress, QEvent::MouseButtonRelease}) {
        QMouseEvent event(type, at, table->viewport()->mapToGlobal(at), Qt::LeftButton,
                          type == QEvent::MouseButtonPress ? Qt::LeftButton : Qt::NoButton, Qt::NoModifier);
        qApp->sendEvent(table->viewport(), &event);
    }
    return Done::yes;
}

// check-cell TABLE ROW COLUMN on|off: a cell with a box to tick, which is not so yet; the panel may be late
Done check_cell(TestDriver& driver, const QString& argument)
{
    auto* table = driver.window()->findChild<QTableWidget*>(argument.section(' ', 0, 0));
    QTableWidgetItem* item =
        table ? table->item(argument.section(' ', 1, 1).toInt(), argument.section(' ', 2, 2).toInt()) : nullptr;
    const auto wanted = argument.section(' ', 3, 3) == "on" ? Qt::Checked : Qt::Unchecked;
    if (!item || !(item->flags() & Qt::ItemIsUserCheckable) || item->checkState() == wanted)
        return driver.until(false, "a cell to tick '" + argument + "'");
    item->setCheckState(wanted);
    return Done::yes;
}

// set-text OBJECT TEXT: a field of the window
Done set_text(TestDriver& driver, const QString& argument)
{
    auto* field = driver.window()->findChild<QLineEdit*>(argument.section(' ', 0, 0));
    if (!field) driver.fail("no field '" + argument + "'");
    field->setText(argument.section(' ', 1));
    return Done::yes;
}

}  // namespace

std::vector<Command> place_commands()
{
    return {
        {"click-place", click_place},
        {"click-cell", click_cell},
        {"check-cell", check_cell},
        {"set-text", set_text},
    };
}
