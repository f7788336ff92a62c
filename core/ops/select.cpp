// Points by region, condition, brush or connectivity: counted, saved, extracted, classified or deleted.
#include "pcm/cloud/vector.h"
#include "pcm/ops/shared/level_arguments.h"
#include "pcm/ops/shared/point_set_actions.h"
#include "pcm/ops/shared/region_arguments.h"
#include "pcm/ops/shared/window_arguments.h"
#include "pcm/ops/shared/work_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/point_cloud.h"
#include "pcm/select/front_points.h"
#include "pcm/select/grow.h"
#include "pcm/select/grow_from.h"
#include "pcm/select/select_points.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "pcm/view/camera.h"

#include <utility>

namespace pcm::ops {
namespace {

// What becomes of the points that a window has selected.
enum class Step : std::uint8_t { replace, add, subtract, intersect, invert, none };

SetOperation set_operation(Step step)
{
    return step == Step::add         ? SetOperation::add
           : step == Step::subtract  ? SetOperation::subtract
           : step == Step::intersect ? SetOperation::intersect
                                     : SetOperation::replace;
}

Json range_of(const Box3d& box) { return box.empty() ? Json() : Json({{"min", box.min}, {"max", box.max}}); }

class Select : public Operation {
public:
    Select()
    {
        arguments_.add("tree", tree_)
            .as(ValueKind::tree)
            .positional()
            .required()
            .only(Face::command)  // a selection belongs to the current layer of a window
            .help("Tree folder, or any file of it");
        arguments_
            .choice("operation", step_,
                    {{"replace", "Replace"},
                     {"add", "Add"},
                     {"subtract", "Subtract"},
                     {"intersect", "Intersect"},
                     {"invert", "Invert selection"},
                     {"none", "Select nothing"}})
            .only(Face::dialog)  // a command line has no selection
            .label("Operation")
            .help(
                "What becomes of the points that are selected already. Replace: they are replaced by the points found. "
                "Add, Subtract, Intersect: the points found are added, taken away, or those that are in both stay. "
                "Invert selection and Select nothing use no other parameter");
        region_.declare(arguments_, group);
        clip_.declare(arguments_);
        declare_brush();
        declare_growth();
        declare_seed_limits();
        actions_.declare(arguments_, "What to do with them (default: count them)");
        arguments_.find("extract")->only(Face::command);  // filters of their own work on a window's selection
        arguments_.find("overwrite")->only(Face::command);
        work_.declare(arguments_, std::uint64_t(256) << 20, "growing and writing");
    }

    Result answer(const Context& context) override
    {
        Result result;
        if (context.face == Face::dialog) {
            select_in_window(context, result);
        } else {
            check(context);
            const auto cloud = context.open(tree_);
            PointSet set = choose(context, *cloud, result);
            if (invert_) set.invert();
            count(context, set, result);
        }
        return result;
    }

private:
    static constexpr const char* group = "Points to select";

    void declare_brush()
    {
        level_.declare(arguments_, "Only the points up to this level", group);
        for (const char* const key : {"level", "error_target"}) arguments_.find(key)->advanced();
        arguments_.add("brush", brush_)
            .points(3, 1, 100000)
            .group(group)
            .label("Brush")
            .help(
                "Points near the stroke through x0 y0 z0 x1 y1 z1 ... (one point: a sphere), within the radius of the "
                "brush; of those that a region or a condition chooses");
        arguments_.add("radius", radius_)
            .not_negative()
            .text_in_dialogs()
            .unit("source units")
            .group(group)
            .label("Radius of the brush")
            .help("Points within this distance of the stroke");
        arguments_.add("front", front_)
            .count(2)
            .group(group)
            .label("Front")
            .help(
                "For a lasso (a region \"lasso ...\"): only points that no others hide, in a view of this width and "
                "height in pixels: 1280 720")
            .advanced();
        arguments_.add("invert", invert_)
            .only(Face::command)  // a step of 'Operation'
            .group(group)
            .help("Select all other points instead");
    }

    void declare_growth()
    {
        arguments_.add("grow_from", grow_from_)
            .count(3)
            .group(group)
            .label("Grow from")
            .help(
                "All points that steps of at most the longest step reach from the point nearest to x y z, through "
                "points that the region, the clips and the conditions choose");
        arguments_.add("grow", grow_)
            .group(group)
            .label("Grow")
            .help(
                "Add to the chosen points all that steps of at most the longest step reach from them; clips limit it");
        arguments_.add("distance", distance_)
            .positive()
            .text_in_dialogs()
            .unit("source units")
            .script("GrowDistance")
            .group(group)
            .label("Longest step")
            .help("Longest step of growing from point to point");
    }

    void declare_seed_limits()
    {
        arguments_.add("within", within_)
            .not_negative()
            .text_in_dialogs()
            .unit("source units")
            .group(group)
            .label("Within")
            .help("Growing from a place: no farther from the seed")
            .advanced();
        arguments_.add("normal_angle", normal_angle_)
            .between(0, 90)
            .degrees()
            .text_in_dialogs()
            .group(group)
            .label("Normals within")
            .help(
                "Growing from a place: only points whose normal is within this angle of the seed's, of either sign, "
                "such as 20")
            .advanced();
        arguments_.add("colour_difference", colour_difference_)
            .between(0, 441.7)
            .text_in_dialogs()
            .group(group)
            .label("Colour difference")
            .help(
                "Growing from a place: only points whose colour is within this distance of the seed's: the distance "
                "between red, green and blue of 0 to 255 each, such as 40")
            .advanced();
    }

    void check(const Context& context) const
    {
        const auto name = [&](const char* key) { return called(context, key); };
        const auto refuse = [](const std::string& what) { throw ArgumentError(what); };
        if (context.face == Face::command) actions_.check(tree_, true);
        if (brush_.empty() != !radius_) refuse(name("brush") + " X Y Z ... and " + name("radius") + " need each other");
        const bool grows = grow_ || !grow_from_.empty();
        if (grows != distance_.has_value())
            refuse(grows ? name("grow") + " and " + name("grow_from") + " need " + name("distance") +
                               ", the longest step from point to point"
                         : name("distance") + " is for " + name("grow") + " and " + name("grow_from"));
        if (grow_ && !grow_from_.empty()) refuse(name("grow") + " and " + name("grow_from") + " cannot be combined");
        if (!brush_.empty() && !grow_from_.empty())
            refuse(name("brush") + " and " + name("grow_from") + " cannot be combined; " + name("grow") +
                   " grows the brush");
        if ((within_ || normal_angle_ || colour_difference_) && grow_from_.empty())
            refuse(name("within") + ", " + name("normal_angle") + " and " + name("colour_difference") +
                   ", which compare with the seed, go with " + name("grow_from"));
        if (!front_.empty() && (grows || !brush_.empty())) refuse(name("front") + " goes with a lasso alone");
        if (level_.given() && grows)
            refuse(name("level") + " and growing cannot be combined: steps pass through all points");
    }

    SelectOptions select_options(const Context& context, const PointCloud& cloud) const
    {
        SelectOptions options;
        options.level = level_.of(*cloud.tree());
        options.threads = work_.threads;
        options.progress = context.progress;
        return options;
    }

    GrowOptions growth(const Context& context, Selection limit) const
    {
        GrowOptions options;
        options.limit = std::move(limit);
        options.memory_bytes = work_.memory;
        options.threads = work_.threads;
        options.progress = context.progress;
        return options;
    }

    // Grown from the point nearest to the one that was given, through what the region and the conditions choose.
    PointSet grown_from_point(const Context& context, PointCloud& cloud, Selection limit, Result& result) const
    {
        const Vec3d given{grow_from_[0], grow_from_[1], grow_from_[2]};
        const std::filesystem::path folder = cloud.tree()->folder();
        const auto nearest = cloud.nearest(given, 1);
        if (nearest.points.empty())
            throw Error(ErrorCode::invalid_argument, folder, "there is no point to grow from: the tree is empty");
        const Neighbour& seed = nearest.points[0];
        SeedLimits like_seed;
        like_seed.within = within_;
        like_seed.colour_difference = colour_difference_;
        like_seed.normal_angle = normal_angle_;
        result.line("grown from the point at " + exact(seed.position) + ", " + brief(seed.distance()) +
                    " source units from the one given");
        PointSet set =
            grow_from(cloud.tree(), seed.node, seed.index, *distance_, like_seed, growth(context, std::move(limit)));
        if (set.empty())
            throw Error(ErrorCode::invalid_argument, folder,
                        "the point nearest to " + exact(given) + ", at " + exact(seed.position) +
                            ", is not among those that the region, the clips and the conditions choose",
                        "grow from another place, or choose this one too");
        return set;
    }

    // Points of the lasso that nothing hides.
    PointSet front_of_lasso(const Context& context, const PointCloud& cloud, Selection selection) const
    {
        const Region::View* const view = selection.region ? selection.region->view() : nullptr;
        if (!view)
            throw ArgumentError(called(context, "front") + " needs a lasso: " + called(context, "region") +
                                " \"lasso ...\"");
        Camera camera;
        camera.modelview = view->modelview;
        camera.projection = view->projection;
        camera.origin = view->origin;
        const auto pixels = [](double given) {
            return given >= 1 && given <= 1e6 ? static_cast<int>(given) : 0;  // 0 is refused with the limits
        };
        camera.width = pixels(front_[0]);
        camera.height = pixels(front_[1]);
        const std::vector<Vec2d> polygon = view->polygon;
        FrontOptions options;
        selection.region.reset();
        options.shown = std::move(selection);
        options.select = select_options(context, cloud);
        return front_points(cloud.tree(), camera, polygon, options);
    }

    PointSet choose(const Context& context, PointCloud& cloud, Result& result) const
    {
        Selection selection = region_.get();
        const bool chooses = selection.chooses_points();
        clip_.add_to(selection, context);
        if (!grow_from_.empty()) return grown_from_point(context, cloud, selection, result);
        if (!front_.empty()) return front_of_lasso(context, cloud, selection);
        if (!chooses && brush_.empty() && !level_.given())
            throw Error(
                ErrorCode::invalid_argument, cloud.tree()->folder(), "no points were chosen",
                "give a region, a condition, " + called(context, "brush") + " or " + called(context, "grow_from"));
        std::vector<Vec3d> stroke;
        for (std::size_t i = 0; i < brush_.size(); i += 3) stroke.push_back({brush_[i], brush_[i + 1], brush_[i + 2]});
        PointSet set = stroke.empty()
                           ? select_points(cloud.tree(), selection, select_options(context, cloud))
                           : brush_points(cloud.tree(), stroke, *radius_, selection, select_options(context, cloud));
        if (!grow_) return set;
        Selection limit;
        limit.clips = selection.clips;
        return ::pcm::grow(set, *distance_, growth(context, std::move(limit)));
    }

    void select_in_window(const Context& context, Result& result) const
    {
        PointCloud& cloud = *context.window.cloud;
        const TreeInfo& info = cloud.info();
        const std::string folder = cloud.tree()->folder().string();
        result.input = {folder};
        PointSet set = context.window.selected ? *context.window.selected : PointSet(cloud.tree());
        std::string how = "filter";
        if (step_ == Step::none) {
            set = PointSet(cloud.tree());
            how = "nothing";
        } else if (step_ == Step::invert) {
            set.invert();
            how = "inverted";
        } else {
            check(context);
            const PointSet found = choose(context, cloud, result);
            result.line(points_text(found.size()) + " found" +
                        (found.empty() ? "; " + extent_text(info.bounds()) + "." : "."));
            set.combine(set_operation(step_), found);
        }
        result.accuracy = LevelArguments::accuracy(*cloud.tree(), level_.of(*cloud.tree()));
        result.outcome.points_in = info.points;
        result.outcome.points_out = set.size();
        result.line(grouped(set.size()) + " of the " + points_text(info.points) + " of " + folder + " are selected.");
        how += ", " + points_text(set.size());
        context.window.select(std::move(set), how);
    }

    void count(const Context& context, const PointSet& set, Result& result) const
    {
        const SetStatistics statistics = statistics_of(set, work_.threads, context.progress);
        const SetDone done = actions_.run(set, context, work_.memory, work_.threads);
        result.input = {tree_};
        if ((grow_ || !grow_from_.empty()) && !invert_)
            if (const std::string note = note_on_growth(set); !note.empty()) result.notes.push_back(note);
        const Box3d cloud = set.tree().info().bounds();
        result.accuracy = LevelArguments::accuracy(set.tree(), level_.of(set.tree()));
        result.outcome.points_in = set.tree().info().points;
        result.outcome.points_out = statistics.points;
        Json& json = result.values;
        json["box"] = range_of(statistics.box);
        json["classes"] = Json::object();
        for (const auto& [value, points] : statistics.classes) json["classes"][std::to_string(value)] = points;
        json["tree_bounds"] = range_of(cloud);
        json["set_bytes"] = set.bytes();
        if (statistics.points == 0) {
            result.line("note: no point is selected; " + extent_text(cloud));
        } else {
            result.line(tree_ + ": " + grouped(statistics.points) + " of " + points_text(set.tree().info().points) +
                        " selected, from " + exact(statistics.box.min) + " to " + exact(statistics.box.max));
            for (const auto& [value, points] : statistics.classes)
                result.line("  class " + std::to_string(value) + ": " + points_text(points));
        }
        put_done(result, done);
    }

    std::string tree_;
    Step step_ = Step::replace;
    RegionArguments region_;
    ClipArgument clip_;
    LevelArguments level_;
    std::vector<double> brush_, grow_from_, front_;
    std::optional<double> radius_, distance_, within_, normal_angle_, colour_difference_;
    bool grow_ = false, invert_ = false;
    PointSetActions actions_;
    WorkArguments work_;
};

}  // namespace

Row select_row()
{
    return {
        "select",
        "Select Points of Point Cloud Tree",
        "Select points of a tree by region, condition, brush or connectivity; count, save, extract, classify or "
        "delete them",
        "Selects points of the <b>point cloud tree</b> that the current layer shows, at full resolution: those in a "
        "region, that meet conditions, or that are connected with a place. The selection is shown in colour; the "
        "filters <i>Selected Points</i> save, extract, classify and delete it. It can be taken back with the tool "
        "<i>Select Points</i>. A selection lasts until the tree changes or the project is closed; in a script of "
        "meshlabserver, for the one run.",
        menu::select | menu::points,
        nullptr,
        with_done_keys({{"box", "object?", "source units", "min and max of the selected points"},
                        {"classes", "object", "points", "how many of each class"},
                        {"tree_bounds", "object?", "source units", "min and max of the tree"},
                        {"set_bytes", "count", "bytes", "memory of the set of points"}}),
        make<Select>,
        {},
        follows_from_points_read};
}

}  // namespace pcm::ops
