// A tree is moved, turned or scaled into a new one.
#include "pcm/cloud/vector.h"
#include "pcm/ops/shared/moved_cloud.h"
#include "pcm/ops/shared/result_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/system/error.h"
#include "pcm/system/tree_folder.h"

namespace pcm::ops {
namespace {

[[noreturn]] void refuse(const std::string& what, const std::string& hint)
{
    throw Error(ErrorCode::invalid_argument, {}, what, hint);
}

class Transform : public Operation {
public:
    Transform()
    {
        target_.declare_cloud(arguments_);
        to_.declare_output(arguments_).positional().letter('o').required();
        arguments_.add("layer_matrix", layer_matrix_)
            .only(Face::dialog)  // the command has no layers
            .label("The layer's matrix")
            .help(
                "Apply the matrix of the layer that shows the tree, as the view does; MeshLab keeps it in single "
                "precision. The numbers below apply after it");
        const char* const group = "Transformation (scaled and rotated about the pivot, then translated)";
        arguments_.add("translate", translate_)
            .count(3)
            .group(group)
            .unit("source units")
            .label("Translate")
            .help("Translation dx dy dz, such as 0 0 -1.5")
            .without("none");
        arguments_.add("rotate", rotate_)
            .count(4)
            .group(group)
            .label("Rotate")
            .help(
                "Rotation about the axis ax ay az by an angle in degrees, counter-clockwise where the axis points to "
                "the viewer: 0 0 1 30. About the pivot")
            .without("none");
        arguments_.add("scale", scale_)
            .group(group)
            .label("Scale")
            .help("Scale factor, such as 0.3048 from feet to metres, about the pivot");
        arguments_.add("matrix", matrix_)
            .count(12)
            .group(group)
            .label("Matrix")
            .advanced()
            .help("Instead of these: twelve numbers, the rows of a 3 x 4 matrix")
            .without("none");
        arguments_.add("pivot", pivot_)
            .count(3)
            .group(group)
            .label("Pivot")
            .help("Point x y z, source coordinates, that rotation and scale leave where it is")
            .without("the centre of the cloud's box");
        to_.declare_work(arguments_);
    }

    Result answer(const Context& context) override
    {
        const auto tree = Tree::open(target_.tree);
        std::vector<Affine> maps;
        if (layer_matrix_ && context.layers)
            if (const auto map = map_of_layer(context, tree->folder())) maps.push_back(*map);
        Result result;
        if (!maps.empty()) result.notes.push_back("the layer's matrix is applied");
        const bool is_typed = !translate_.empty() || !rotate_.empty() || !matrix_.empty() || scale_ != 1;
        if (!is_typed && maps.empty() && context.layers)
            refuse("no transformation was given, and the layer has no matrix",
                   "move the layer, or give a translation, a rotation or a scale");
        if (is_typed || maps.empty()) maps.push_back(typed_map(context, tree->info().bounds()));
        const BuildReport report = write_moved(tree, maps, to_.output, to_.build_options(context));
        result.input = {target_.tree};
        put_moved(result, to_.output, report);
        return result;
    }

private:
    // The current layer's where it shows the tree, else the first one's that does.
    static std::optional<Affine> map_of_layer(const Context& context, const std::filesystem::path& tree)
    {
        std::optional<Affine> map;
        bool found = false;
        for (const Layer& layer : context.layers()) {
            if (!same_tree_folder(layer.tree, tree)) continue;
            if (!found || layer.current) map = layer.map;
            found = true;
        }
        return map;
    }

    Affine typed_map(const Context& context, const Box3d& box) const
    {
        Vec3d pivot = box.empty() ? Vec3d{0, 0, 0} : box.centre();
        if (!pivot_.empty()) pivot = {pivot_[0], pivot_[1], pivot_[2]};
        const std::string matrix = called(context, "matrix"), rotate = called(context, "rotate"),
                          scale = called(context, "scale"), translate = called(context, "translate");
        if (!matrix_.empty()) {
            if (!rotate_.empty() || scale_ != 1 || !translate_.empty())
                refuse(matrix + " cannot be combined with " + rotate + ", " + scale + " or " + translate,
                       "the matrix replaces all of them");
            return matrix_about(pivot);
        }
        if (rotate_.empty() && scale_ == 1 && translate_.empty())
            refuse("no transformation was given", "give " + translate + ", " + rotate + ", " + scale + " or " + matrix);
        Vec3d axis{0, 0, 1};
        double radians = 0;
        if (!rotate_.empty()) {
            axis = {rotate_[0], rotate_[1], rotate_[2]};
            if (axis == Vec3d{0, 0, 0})
                refuse("the axis of " + rotate + " has length zero",
                       "0 0 1 30 rotates by 30 degrees about the vertical axis");
            radians = rotate_[3] * pi / 180;
        }
        Affine map;
        if (radians == 0) {  // positions keep their grid
            map.pivot = map.target = pivot;
            for (std::size_t a = 0; a < 3; ++a) map.linear[a][a] = scale_;
            if (scale_ == 1) map.pivot = map.target = {0, 0, 0};
        } else {
            map = Affine::rotation(axis, radians, pivot, scale_);
        }
        for (std::size_t a = 0; a < 3 && !translate_.empty(); ++a) map.target[a] += translate_[a];
        return map;
    }

    Affine matrix_about(const Vec3d& pivot) const
    {
        std::array<Vec3d, 3> linear;
        Vec3d shift;
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) linear[i][j] = matrix_[i * 4 + j];
            shift[i] = matrix_[i * 4 + 3];
        }
        return Affine::about(linear, shift, pivot);
    }

    TargetArguments target_;
    NewCloudArguments to_;
    bool layer_matrix_ = true;
    std::vector<double> translate_, rotate_, matrix_, pivot_;
    double scale_ = 1;
};

}  // namespace

Row transform_row()
{
    return {"transform",
            "Transform Point Cloud Tree",
            "Translate, rotate or scale a tree into a new tree",
            "Writes a <b>point cloud tree</b> that is moved, turned or scaled: by the layer's matrix, as MeshLab's own "
            "tools set it, by numbers, or both. The new layer has no matrix, and its points are where the old layer "
            "shows them. The old tree is not changed.",
            menu::points | menu::normals,
            "-moved.pct",
            {{"position_error", "number", "source units", "largest position error"},
             {"bytes", "count", "bytes", "size of the result"}},
            make<Transform>,
            {"translate"},
            only_rounds};
}

}  // namespace pcm::ops
