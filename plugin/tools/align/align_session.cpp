#include "plugin/tools/align/align_session.h"

#include "pcm/align/pair_text.h"
#include "pcm/align/pick_spacing.h"
#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"
#include "plugin/scene/layer_matrix.h"
#include "plugin/scene/text.h"
#include "plugin/tools/align/align_marks.h"

#include <utility>

namespace pcm::host {

namespace {

SceneLayer* cloud_layer(Scene& scene, int layer_id)
{
    SceneLayer* const layer = layer_id < 0 ? nullptr : scene.layer(layer_id);
    return layer && layer->drawn() ? layer : nullptr;
}

std::string name_of(const SceneLayer* layer) { return layer ? "'" + layer->label().toStdString() + "'" : "none"; }

}  // namespace

AlignSession::AlignSession(Scene& scene) : QObject(&scene), scene_(scene)
{
    connect(&scene, &Scene::layer_removed, this, [this](int layer_id) {
        if (layer_id == moving_ || layer_id == fixed_)
            choose(layer_id == moving_ ? -1 : moving_, layer_id == fixed_ ? -1 : fixed_);
    });
    connect(&scene.part<LayerMatrices>(), &LayerMatrices::changed, this, &AlignSession::refresh);
    update();
}

SceneLayer* AlignSession::moving() const { return cloud_layer(scene_, moving_); }

SceneLayer* AlignSession::fixed() const { return cloud_layer(scene_, fixed_); }

void AlignSession::choose(int moving, int fixed)
{
    if (moving == moving_ && fixed == fixed_) return;
    for (PickedPair& pair : pairs_) {
        if (moving != moving_) pair.moving.reset();
        if (fixed != fixed_) pair.fixed.reset();
    }
    moving_ = moving;
    fixed_ = fixed;
    selected_ = -1;
    std::vector<PickedPair> kept;
    for (const PickedPair& pair : pairs_)
        if (pair.moving || pair.fixed) kept.push_back(pair);
    pairs_ = std::move(kept);
    update();
}

void AlignSession::choose_first()
{
    if (this->moving() && this->fixed()) return;
    int moving = scene_.current() && cloud_layer(scene_, scene_.current()->id()) ? scene_.current()->id() : -1,
        fixed = -1;
    for (const SceneLayer* layer : scene_.layers()) {
        if (!layer || !layer->is_visible() || !cloud_layer(scene_, layer->id())) continue;
        if (moving < 0)
            moving = layer->id();
        else if (fixed < 0 && layer->id() != moving)
            fixed = layer->id();
    }
    choose(moving, fixed);
}

void AlignSession::swap()
{
    std::swap(moving_, fixed_);
    for (PickedPair& pair : pairs_) std::swap(pair.moving, pair.fixed);
    update();
}

QString AlignSession::take(const Picked& point)
{
    if (point.layer_id != moving_ && point.layer_id != fixed_) {
        const SceneLayer* layer = scene_.layer(point.layer_id);
        return QString::fromStdString("This point is of the layer " + name_of(layer) +
                                      ", and the layers to align are " + name_of(moving()) + " and " +
                                      name_of(fixed()) + ".");
    }
    const auto end = point.layer_id == moving_ ? &PickedPair::moving : &PickedPair::fixed;
    std::size_t pair = 0;
    if (selected_ >= 0) {
        pair = std::size_t(selected_);
    } else {
        while (pair < pairs_.size() && pairs_[pair].*end) ++pair;
        if (pair == pairs_.size()) pairs_.emplace_back();
    }
    pairs_[pair].*end = PickedEnd{point.position, point.spacing};
    if (selected_ >= 0 && pairs_[pair].is_complete()) selected_ = -1;
    update();
    return QString("Pair %1: the %2 point is %3.")
        .arg(pair + 1)
        .arg(point.layer_id == moving_ ? "moving" : "fixed", QString::fromStdString(exact(point.position)));
}

void AlignSession::select(int pair)
{
    selected_ = pair >= 0 && std::size_t(pair) < pairs_.size() ? pair : -1;
    emit changed();
}

void AlignSession::remove(int pair)
{
    if (pair < 0 || std::size_t(pair) >= pairs_.size()) return;
    pairs_.erase(pairs_.begin() + pair);
    selected_ = -1;
    update();
}

void AlignSession::clear()
{
    pairs_.clear();
    selected_ = -1;
    update();
}

void AlignSession::load(const std::string& file)
{
    std::vector<PickedPair> loaded;
    const auto spacing = [](SceneLayer* layer, const Vec3d& place) {
        const auto tree = layer ? layer->drawn() : std::nullopt;
        return tree ? spacing_at(*tree->cloud, place).spacing : 0.0;
    };
    for (const PointPair& pair : read_pairs(file))
        loaded.push_back({PickedEnd{pair.moving, spacing(moving(), pair.moving)},
                          PickedEnd{pair.fixed, spacing(fixed(), pair.fixed)}, pair.weight});
    pairs_ = std::move(loaded);
    selected_ = -1;
    update();
}

void AlignSession::save(const std::string& file) const
{
    std::vector<PointPair> complete;
    for (const PickedPair& pair : pairs_)
        if (pair.is_complete()) complete.push_back({pair.moving->position, pair.fixed->position, pair.weight});
    if (complete.empty())
        throw Error(ErrorCode::invalid_argument, file, "there is no complete pair to save",
                    "pick both points of a pair");
    write_pairs(complete, file);
}

void AlignSession::set_scale(bool on)
{
    with_scale_ = on;
    update();
}

int AlignSession::number_in_fit(std::size_t pair) const
{
    if (!pairs_[pair].is_complete()) return -1;
    int number = 0;
    for (std::size_t i = 0; i < pair; ++i) number += pairs_[i].is_complete();
    return number;
}

std::optional<Vec3d> AlignSession::shown(const PickedEnd& end, bool moving) const
{
    const SceneLayer* layer = moving ? this->moving() : fixed();
    if (!layer) return std::nullopt;
    const auto placement = layer->placement();
    return placement ? (*placement)(end.position) : end.position;
}

void AlignSession::update()
{
    fit_.reset();
    problem_.clear();
    std::vector<PointPair> pairs;
    std::vector<double> spacings;
    for (const PickedPair& pair : pairs_) {
        if (!pair.is_complete()) continue;
        pairs.push_back({pair.moving->position, shown(*pair.fixed, false).value_or(pair.fixed->position), pair.weight});
        spacings.push_back(pair.moving->spacing);
        spacings.push_back(pair.fixed->spacing);
    }
    try {
        if (!moving() || !fixed())
            throw Error(ErrorCode::invalid_argument, {}, "two layers of point clouds are needed",
                        "choose the layer that moves and the one that is fixed");
        if (moving_ == fixed_)
            throw Error(ErrorCode::invalid_argument, {}, "both layers are the same", "choose another fixed layer");
        FitOptions options;
        options.scale = with_scale_;
        options.pick_error = pick_error_of(spacings);
        fit_ = fit_motion(pairs, options);
    } catch (...) {
        problem_ = QString::fromStdString(current_error());
    }
    draw_marks(*this);
    emit changed();
}

void AlignSession::refresh() { update(); }

std::vector<std::string> AlignSession::apply()
{
    if (!fit_) throw Error(ErrorCode::invalid_argument, {}, problem_.toStdString());
    const RigidFit fit = *fit_;
    SceneLayer& layer = *moving();
    const LayerCloud tree = *layer.drawn();
    scene_.part<LayerMatrices>().set(layer, matrix_of(fit.motion, tree.origin),
                                     QString("align by %1 pairs").arg(fit.residuals.size()));
    std::vector<std::string> lines{"Aligned the layer " + name_of(&layer) + " to " + name_of(fixed()) + " by " +
                                   std::to_string(fit.residuals.size()) + " pairs: RMS of the residuals " +
                                   exact(fit.rms) + " source units."};
    for (std::size_t i = 0; i < fit.residuals.size(); ++i)
        lines.push_back("Pair " + std::to_string(i + 1) + ": residual " + brief(fit.residuals[i]) + ".");
    lines.push_back("The matrix, which MeshLab keeps in single precision, moves points by up to " +
                    brief(matrix_rounding(fit.motion, tree.origin, tree.cloud->info().bounds())) +
                    " source units more or less than the motion.");
    return lines;
}

QString summary_of(const AlignSession& session)
{
    if (!session.fit()) return session.problem();
    const RigidFit& fit = *session.fit();
    const LayerCloud tree = *session.moving()->drawn();
    const Box3d box = tree.cloud->info().bounds();
    const std::string text =
        "RMS " + brief(fit.rms) + ", rotation " + brief(fit.radians * 180 / pi) + " degrees, " +
        (session.with_scale() ? "scale " + exact(fit.scale)
                              : "scale of the pairs " + brief(fit.pairs_scale) + " (not applied)") +
        "\nUncertainty: " + brief(fit.error_at(fit.motion.pivot)) + " at the pairs' centroid, up to " +
        brief(fit.largest_error(box)) + " at the cloud's corners\nRounding of the layer's matrix: up to " +
        brief(matrix_rounding(fit.motion, tree.origin, box)) + "; a moved tree has none. Source units.";
    return QString::fromStdString(text);
}

}  // namespace pcm::host
