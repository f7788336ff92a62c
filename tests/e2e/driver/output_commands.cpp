#include "plugin/meshlab/meshlab.h"
#include "tests/e2e/driver/commands.h"
#include "tests/e2e/driver/paint_witness.h"

#include <QFile>
#include <QGuiApplication>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QMainWindow>
#include <QScreen>
#include <QTimer>
#include <QVariantMap>

#include <time.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace {

long resident_bytes(const char* key)
{
    QFile file("/proc/self/status");
    if (!file.open(QIODevice::ReadOnly)) return 0;
    for (const QByteArray& line : file.readAll().split('\n'))
        if (line.startsWith(key))
            return line.mid(static_cast<int>(qstrlen(key))).simplified().split(' ')[0].toLong() * 1024;
    return 0;
}

QString compact(const QJsonObject& object) { return QJsonDocument(object).toJson(QJsonDocument::Compact); }

// time NAME: milliseconds since MeshLab's start
Done time(TestDriver& driver, const QString& name)
{
    say(QString("time %1 %2 ms").arg(name).arg(driver.started.elapsed()));
    return Done::yes;
}

// memory NAME
Done memory(TestDriver&, const QString& name)
{
    say(QString("memory %1 now %2 peak %3").arg(name).arg(resident_bytes("VmRSS:")).arg(resident_bytes("VmHWM:")));
    return Done::yes;
}

Done print_layers(TestDriver& driver, const QString&)
{
    for (const MeshModel* layer : pcm::host::models_of(*driver.document())) {
        QStringList attributes;
        for (const auto& attribute : layer->cm.vert_attr) attributes << QString::fromStdString(attribute._name);
        Box3m box;
        QJsonArray matrix;  // row by row
        for (int i = 0; i < 16; ++i) matrix << layer->cm.Tr.V()[i];
        for (const auto& vertex : layer->cm.vert) box.Add(vertex.cP());
        say("layer " + compact({{"label", layer->label()},
                                {"vertices", layer->cm.vn},
                                {"faces", layer->cm.fn},
                                {"visible", pcm::host::is_shown(*layer)},
                                {"shown", driver.area()->meshVisibilityMap.value(layer->id())},
                                {"current", layer == driver.document()->mm()},
                                {"matrix", matrix},
                                {"min", QJsonArray{box.min[0], box.min[1], box.min[2]}},
                                {"max", QJsonArray{box.max[0], box.max[1], box.max[2]}},
                                {"colours", layer->hasDataMask(MeshModel::MM_VERTCOLOR)},
                                {"modified", layer->meshModified()},
                                {"quality", layer->hasDataMask(MeshModel::MM_VERTQUALITY)},
                                {"attributes", QJsonArray::fromStringList(attributes)}}));
    }
    return Done::yes;
}

// print-camera NAME: MeshLab's camera in the document's coordinates, and the state of the first-person tool
Done print_camera(TestDriver& driver, const QString& name)
{
    GLArea* area = driver.area();
    const QMainWindow* window = driver.window();
    const vcg::Similarityf& track = area->trackball.track;
    const auto [distance, orthographic] =
        area->fov <= 5 ? std::pair(8.0, true) : std::pair(1.75 / std::tan(double(area->fov) * M_PI / 360), false);
    const auto to_scene = [&](const vcg::Point3f& p) {
        const vcg::Point3f q = track.rot.Inverse().Rotate(p) / track.sca - track.tra;
        return QJsonArray{q[0], q[1], q[2]};
    };
    const QVariantMap walk = area->property("pcm_first_person").toMap();
    say("camera " + compact({{"name", name},
                             {"eye", to_scene(vcg::Point3f(0, 0, float(distance)))},
                             {"centre", to_scene(vcg::Point3f(0, 0, 0))},
                             {"above", to_scene(vcg::Point3f(0, 1, 0))},
                             {"scale", track.sca},
                             {"near", area->nearPlane},
                             {"orthographic", orthographic},
                             {"keys", walk["keys"].toInt()},
                             {"moving", walk["moving"].toBool()},
                             {"factor", walk["factor"].toDouble()},
                             {"roll", walk["roll"].toDouble()},
                             {"reach", walk["reach"].toDouble()},
                             {"reach_error", walk["reach_error"].toDouble()},
                             {"window", QJsonArray{window->width(), window->height()}},
                             {"full_screen", window->isFullScreen()}}));
    return Done::yes;
}

// print-boxes: the boxes of text in the view
Done print_boxes(TestDriver& driver, const QString&)
{
    const PaintWitness witness(driver.area());
    driver.area()->repaint();
    for (auto box = witness.boxes.cbegin(); box != witness.boxes.cend(); ++box)
        say("box " + compact({{"title", box.key()}, {"layer", box->first}, {"text", box->second}}));
    return Done::yes;
}

// print-parameters NAME: the settings of point clouds
Done print_parameters(TestDriver& driver, const QString& name)
{
    QJsonObject values{{"name", name}};
    QJsonArray without_default;  // in the tooltip
    for (const RichParameter& parameter : *driver.area()->glas.currentGlobalParamSet) {
        if (!parameter.name().startsWith("MeshLab::PointCloud::")) continue;
        if (!parameter.toolTip().contains("efault")) without_default << parameter.name();
        const Value& value = parameter.value();
        const auto choice = pcm::host::choice_of(value);
        values[parameter.name().section("::", -1)] = value.isFloat()    ? QJsonValue(double(value.getFloat()))
                                                     : choice           ? QJsonValue(*choice)
                                                     : value.isBool()   ? QJsonValue(value.getBool())
                                                     : value.isInt()    ? QJsonValue(value.getInt())
                                                     : value.isColor()  ? QJsonValue(value.getColor().name())
                                                     : value.isString() ? QJsonValue(value.getString())
                                                                        : QJsonValue();
    }
    values["without_default"] = without_default;
    say("parameters " + compact(values));
    return Done::yes;
}

// The longest time between two turns of the window's event loop, and what of it the window's thread computed; the rest
// it waited, for the graphics card or for a processor.
struct Turns {
    QTimer timer;
    QElapsedTimer since;
    double before_cpu = 0, longest_ms = 0, longest_cpu_ms = 0;

    static double cpu_ms()
    {
        timespec time{};
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
        return double(time.tv_sec) * 1e3 + double(time.tv_nsec) / 1e6;
    }
    Turns()
    {
        timer.setTimerType(Qt::PreciseTimer);
        timer.setInterval(1);
        since.start();
        before_cpu = cpu_ms();
        QObject::connect(&timer, &QTimer::timeout, [this] {
            longest_ms = std::max(longest_ms, double(since.nsecsElapsed()) / 1e6);
            longest_cpu_ms = std::max(longest_cpu_ms, cpu_ms() - before_cpu);
            since.restart();
            before_cpu = cpu_ms();
        });
        timer.start();
    }
};
std::unique_ptr<Turns> turns;

// watch-turns: from now on, until print-turns
Done watch_turns(TestDriver&, const QString&)
{
    turns = std::make_unique<Turns>();
    return Done::yes;
}

Done print_turns(TestDriver&, const QString&)
{
    say("turns " + compact({{"longest_ms", turns->longest_ms}, {"longest_cpu_ms", turns->longest_cpu_ms}}));
    turns.reset();
    return Done::yes;
}

// count-paints: from now on, until print-paints
Done count_paints(TestDriver& driver, const QString&)
{
    driver.witness = std::make_unique<PaintWitness>(driver.area());
    return Done::yes;
}

Done print_paints(TestDriver& driver, const QString&)
{
    say("paints " + compact({{"all", driver.witness->paints}, {"native", driver.witness->native_paints}}));
    driver.witness.reset();
    return Done::yes;
}

// picture FILE: the view without MeshLab's texts
Done picture(TestDriver& driver, const QString& file)
{
    GLArea* view = driver.area();
    const bool texts = view->infoAreaVisible, ball = view->isTrackBallVisible();
    view->infoAreaVisible = false;
    view->showTrackBall(false);
    view->repaint();  // grabFrameBuffer reads what was drawn last
    const QImage image = view->grabFrameBuffer();
    view->infoAreaVisible = texts;
    view->showTrackBall(ball);
    if (!image.save(file)) driver.fail("cannot write " + file);
    say(QString("picture %1 %2x%3, %4").arg(file).arg(image.width()).arg(image.height()).arg(driver.status()));
    return Done::yes;
}

// screen FILE: the whole screen
Done screen(TestDriver& driver, const QString& file)
{
    if (!QGuiApplication::primaryScreen()->grabWindow(0).save(file)) driver.fail("cannot write " + file);
    return Done::yes;
}

}  // namespace

std::vector<Command> output_commands()
{
    return {
        {"time", time},
        {"memory", memory},
        {"print-status",
         [](TestDriver& driver, const QString&) { return say("status " + driver.status()), Done::yes; }},
        {"print-log",
         [](TestDriver& driver, const QString&) { return say("log " + driver.log().replace('\n', " | ")), Done::yes; }},
        {"print-legend",
         [](TestDriver& driver, const QString& name) {
             const QStringList lines = driver.area()->property("pcm_state").toMap()["legend"].toStringList();
             say("legend " + compact({{"name", name}, {"lines", QJsonArray::fromStringList(lines)}}));
             return Done::yes;
         }},
        {"print-layers", print_layers},
        {"print-camera", print_camera},
        {"print-boxes", print_boxes},
        {"print-parameters", print_parameters},
        {"watch-turns", watch_turns},
        {"print-turns", print_turns},
        {"count-paints", count_paints},
        {"print-paints", print_paints},
        {"picture", picture},
        {"screen", screen},
    };
}
