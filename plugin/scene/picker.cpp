#include "plugin/scene/picker.h"

#include "pcm/cloud/vector.h"
#include "pcm/pick/describe_point.h"
#include "pcm/pick/point_picker.h"
#include "pcm/query/local_spacing.h"
#include "pcm/system/error.h"
#include "plugin/scene/scene_state.h"
#include "plugin/scene/shown_points.h"
#include "plugin/scene/text.h"

#include <QCoreApplication>
#include <QPointer>
#include <QThreadPool>

#include <atomic>
#include <cmath>
#include <map>
#include <utility>

namespace pcm::host {

namespace {

constexpr double tolerance = 4;  // Qt's pixels

// A layer whose cloud may be hit.
struct Target {
    int layer_id = -1;
    LayerCloud tree;  // keeps a drawn copy's folder
    std::shared_ptr<PointPicker> picker;
    std::optional<Affine> placement;
    PickRay ray;  // as the cloud sees it
    PickOptions options;
};

struct Job {
    std::vector<Target> targets;
    QString nothing;  // the message if there is no point
    QPointer<SceneView> view;
    QPointer<QObject> context;  // used in the GUI thread only
    std::function<void(const PickAnswer&)> answer;
    std::atomic<bool> replaced{false};
};

// The job of each context; null after its end. GUI thread.
std::map<const QObject*, std::shared_ptr<Job>>& jobs()
{
    static auto* const jobs = new std::map<const QObject*, std::shared_ptr<Job>>;
    return *jobs;
}

// A picker knows the sizes of a tree's points, and boxes around them. GUI thread.
std::shared_ptr<PointPicker> picker_of(const std::shared_ptr<PointCloud>& cloud)
{
    struct Entry {
        std::weak_ptr<PointCloud> cloud;
        std::shared_ptr<PointPicker> picker;
    };
    static auto* const pickers = new std::map<const PointCloud*, Entry>;
    for (auto entry = pickers->begin(); entry != pickers->end();)
        entry = entry->second.cloud.expired() ? pickers->erase(entry) : std::next(entry);
    Entry& entry = (*pickers)[cloud.get()];
    if (!entry.picker) entry = {cloud, std::make_shared<PointPicker>(cloud->cache())};
    return entry.picker;
}

std::vector<Target> targets_of(SceneView& view, const Camera& camera, const ShownClouds& shown, double x, double y,
                               double end)
{
    std::vector<Target> targets;
    for (const int layer_id : shown.layers) {
        SceneLayer* const layer = view.scene().layer(layer_id);
        const auto tree = layer ? layer->drawn() : std::nullopt;
        if (!tree || !view.is_shown(*layer)) continue;
        Target target;
        target.layer_id = layer_id;
        target.tree = *tree;
        target.placement = layer->placement();
        Camera in_scene = camera;
        in_scene.origin = tree->origin;
        auto ray = PickRay::through(in_scene, x, y);
        if (!ray) continue;
        ray->end = std::min(ray->end, end);
        if (target.placement) ray = ray->before(*target.placement);
        if (!ray) continue;
        target.ray = *ray;
        target.options.tolerance_px = tolerance * view.pixel_ratio();
        target.options.size_scale = shown.size_scale;
        target.options.fitted = shown.fitted;
        target.options.where = applicable(shown.where, tree->cloud->info().schema);
        if (const auto clip = clip_of(*layer)) target.options.clips.push_back(*clip);
        target.picker = picker_of(tree->cloud);
        targets.push_back(std::move(target));
    }
    return targets;
}

Picked picked_of(const Target& target, const PickHit& hit)
{
    Picked picked;
    picked.layer_id = target.layer_id;
    picked.cloud = target.tree.cloud;
    picked.node = hit.node;
    picked.point = hit.index;
    picked.position = hit.position;
    picked.shown_at = target.placement ? (*target.placement)(hit.position) : hit.position;
    picked.spacing = hit.size;
    if (target.placement) picked.scale = std::cbrt(std::abs(target.placement->determinant()));
    const Vec3d& step = target.tree.cloud->info().grid.scale;
    picked.grid_step = std::max({step[0], step[1], step[2]});
    return picked;
}

void describe(const Target& target, Picked& picked)
{
    const PointDescription description =
        describe_point(target.tree.cloud->cache(), target.picker->sizes(), picked.node, picked.point);
    for (const DescribedAttribute& attribute : description.attributes)
        picked.attributes.push_back({attribute.name, attribute.text()});
    picked.position_text = description.position_text;
    picked.spacing_around = local_spacing(target.tree.cloud->cache(), picked.position);
}

// The nearest hit of all clouds: with `known`, hits of the same targets, exactly; else of what is in memory.
using Hits = std::vector<std::optional<PickHit>>;
std::optional<std::size_t> search(const Job& job, Hits& hits, const Hits* known)
{
    std::optional<std::size_t> nearest;
    double depth = std::numeric_limits<double>::infinity();  // scene units
    for (std::size_t i = 0; i < job.targets.size(); ++i) {
        const Target& target = job.targets[i];
        PickOptions options = target.options;
        options.most_depth = depth * target.ray.scale;
        options.cancelled = [&job] { return job.replaced.load(); };
        hits[i] = known ? target.picker->exact(target.ray, options, (*known)[i]).hit
                        : target.picker->in_memory(target.ray, options).hit;
        if (!hits[i] || !(hits[i]->depth / target.ray.scale < depth)) continue;
        depth = hits[i]->depth / target.ray.scale;
        nearest = i;
    }
    return nearest;
}

// In the GUI thread.
void give(const std::shared_ptr<Job>& job, const PickAnswer& answer)
{
    const auto current = job->context ? jobs().find(job->context.data()) : jobs().end();
    if (current == jobs().end() || current->second != job || !job->view) return;
    if (answer.final) current->second = nullptr;
    job->answer(answer);
}

void post(const std::shared_ptr<Job>& job, PickAnswer answer)
{
    if (QCoreApplication* const application = QCoreApplication::instance())
        QMetaObject::invokeMethod(
            application, [job, answer = std::move(answer)] { give(job, answer); }, Qt::QueuedConnection);
}

// On a thread of the pool.
void run(const std::shared_ptr<Job>& job)
{
    PickAnswer last;
    try {
        Hits first(job->targets.size()), exact(job->targets.size());
        if (const auto nearest = search(*job, first, nullptr)) {
            PickAnswer answer;
            answer.point = picked_of(job->targets[*nearest], *first[*nearest]);
            answer.final = false;
            post(job, answer);
        }
        if (const auto nearest = search(*job, exact, &first)) {
            last.point = picked_of(job->targets[*nearest], *exact[*nearest]);
            describe(job->targets[*nearest], *last.point);
        } else {
            last.message = job->nothing;
        }
    } catch (...) {
        if (job->replaced) return;
        last = {};
        last.message = QString("The point could not be picked: %1").arg(QString::fromStdString(current_error()));
    }
    post(job, last);
}

}  // namespace

void pick(SceneView& view, const QPoint& place, QObject& context, const std::function<void(const PickAnswer&)>& answer)
{
    const auto job = std::make_shared<Job>();
    job->view = &view;
    job->context = &context;
    job->answer = answer;
    job->nothing = "No point within 4 pixels of the cursor";
    const auto former = jobs().find(&context);
    if (former == jobs().end())
        QObject::connect(&context, &QObject::destroyed, QCoreApplication::instance(),
                         [key = static_cast<const QObject*>(&context)] {
                             const auto found = jobs().find(key);
                             if (found == jobs().end()) return;
                             if (found->second) found->second->replaced = true;
                             jobs().erase(found);
                         });
    else if (former->second)
        former->second->replaced = true;
    jobs()[&context] = job;

    const auto& camera = view.camera();
    const auto& shown = view.shown();
    const double ratio = view.pixel_ratio();
    const double x = (place.x() + 0.5) * ratio, y = (place.y() + 0.5) * ratio;
    const auto scene_ray = camera ? PickRay::through(*camera, x, y) : std::nullopt;
    if (!scene_ray || !shown || shown->layers.empty()) {
        job->nothing = "No point cloud is shown in this view";
    } else {
        const Occluder occluder = view.find_occluder(*scene_ray);
        if (!occluder.layer.isNull())
            job->nothing =
                QString("No point within 4 pixels of the cursor in front of the layer %1").arg(occluder.layer);
        job->targets = targets_of(view, *camera, *shown, x, y, occluder.along);
    }
    QThreadPool::globalInstance()->start([job] { run(job); });
}

}  // namespace pcm::host
