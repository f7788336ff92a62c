// The clip box of the tool: handles and what dragging them does, history, and the text that projects keep.
#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"
#include "plugin/meshlab/document_scene.h"
#include "plugin/scene/clip_history.h"
#include "plugin/scene/clip_text.h"
#include "plugin/scene/project_parts.h"
#include "plugin/tools/clip/box_handles.h"
#include "tests/plugin/cameras.h"
#include "tests/plugin/met_document.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace pcm;
using namespace pcm::host;

namespace {

const Vec3d far_place{500000, 4800000, 100};

ClipBox box_at(const Vec3d& centre, double turn = 0)
{
    ClipBox box;
    box.centre = centre;
    box.half = {1, 2, 0.5};
    return turned(box, turn);
}

QPointF pixel_of(const ViewMap& view, const Vec3d& place) { return *view.pixel_of(place); }

bool near(const Vec3d& a, const Vec3d& b, double tolerance) { return length(a - b) <= tolerance; }

TEST(ClipBox, TheHandleUnderTheCursorIsTheNearestOne)
{
    const ViewMap view(test::camera_at(far_place, false), 1);
    const ClipBox box = box_at(far_place, 20);
    for (const BoxHandle& handle : all_handles()) {
        const QPointF at = pixel_of(view, place_of(box, handle));
        const auto found = handle_at(box, view, at + QPointF(2, -1), 9);
        ASSERT_TRUE(found);
        EXPECT_TRUE(*found == handle);
    }
    EXPECT_FALSE(handle_at(box, view, {5, 5}, 9));
}

TEST(ClipBox, ADraggedFaceFollowsTheCursorAndTheOppositeOneStays)
{
    for (const bool parallel : {false, true}) {
        const ViewMap view(test::camera_at(far_place, parallel), 1);
        const ClipBox box = box_at(far_place, 30);
        for (const BoxHandle& handle : all_handles()) {
            if (handle.kind != BoxHandle::Kind::face) continue;
            const Vec3d outwards = handle.side * box.axes[handle.axis];
            const Vec3d from = place_of(box, handle), to = from + 0.4 * outwards;
            const ClipBox moved = dragged(box, handle, view, pixel_of(view, from), pixel_of(view, to));
            EXPECT_TRUE(near(place_of(moved, handle), to, 1e-7));
            const BoxHandle opposite{BoxHandle::Kind::face, handle.axis, -handle.side};
            EXPECT_TRUE(near(place_of(moved, opposite), place_of(box, opposite), 1e-8));
            for (std::size_t k = 0; k < 3; ++k)
                EXPECT_NEAR(moved.half[k], box.half[k] + (k == handle.axis ? 0.2 : 0), 1e-7);
            // Through the opposite face: a size stays above 0.
            const ClipBox thin = dragged(box, handle, view, pixel_of(view, from), pixel_of(view, from - 5 * outwards));
            EXPECT_EQ(thin.half[handle.axis], least_half(box));
            EXPECT_TRUE(near(place_of(thin, opposite), place_of(box, opposite), 1e-6));
        }
    }
}

TEST(ClipBox, TheCentreMovesInTheViewOrAlongTheThinnestAxis)
{
    const ViewMap view(test::camera_at(far_place, false), 1);
    const ClipBox box = box_at(far_place);
    const BoxHandle centre;
    const Vec3d right = normalised(cross({0, 0, 1}, view.back())), to = box.centre + 0.7 * right;
    const QPointF from = pixel_of(view, box.centre);
    EXPECT_TRUE(near(dragged(box, centre, view, from, pixel_of(view, to)).centre, to, 1e-7));
    EXPECT_EQ(thinnest_axis(box), 2u);
    const Vec3d above = box.centre + Vec3d{0, 0, 0.3};
    EXPECT_TRUE(near(dragged(box, centre, view, from, pixel_of(view, above), true).centre, above, 1e-7));
    EXPECT_EQ(dragged(box, centre, view, from, pixel_of(view, above), true).half, box.half);
}

TEST(ClipBox, TurningFollowsTheCursor)
{
    const ViewMap view(test::camera_at(far_place, false), 1);
    const ClipBox box = box_at(far_place, 10);
    const BoxHandle turn{BoxHandle::Kind::turn, 0, 1};
    const ClipBox goal = turned(box, 25);
    const ClipBox found =
        dragged(box, turn, view, pixel_of(view, place_of(box, turn)), pixel_of(view, place_of(goal, turn)));
    EXPECT_NEAR(*turn_of(found), 35, 1e-6);
    EXPECT_EQ(found.half, box.half);
    EXPECT_EQ(found.centre, box.centre);
    ClipBox round = box;
    for (int i = 0; i < 3600; ++i) round = turned(round, 0.1);  // axes stay perpendicular
    EXPECT_NEAR(*turn_of(round), 10, 1e-9);
    EXPECT_LT(std::fabs(dot(round.axes[0], round.axes[1])), 1e-15);
    ClipBox tilted = box;
    tilted.axes = {Vec3d{1, 0, 0}, Vec3d{0, 0, 1}, Vec3d{0, -1, 0}};
    EXPECT_FALSE(turn_of(tilted));
}

TEST(ClipBox, SlabsAndSections)
{
    const Box3d clouds{far_place - Vec3d{30, 20, 5}, far_place + Vec3d{30, 20, 5}};
    const ClipBox slab = slab_of(box_at(far_place + Vec3d{1, 2, 0.25}, 15), 2, 0.1, clouds);
    EXPECT_NEAR(slab.half[2], 0.05, 1e-15);
    EXPECT_EQ(slab.centre[2], far_place[2] + 0.25);
    const Clip clip = slab.clip(std::nullopt);
    for (const double x : {-30.0, 30.0})
        for (const double y : {-20.0, 20.0}) {
            EXPECT_TRUE(clip.holds(far_place + Vec3d{x, y, 0.25}));
            EXPECT_FALSE(clip.holds(far_place + Vec3d{x, y, 0.31}));
        }
    EXPECT_NEAR(stepped(slab, 2, 3).centre[2], far_place[2] + 0.55, 1e-9);

    const Vec3d a = far_place + Vec3d{-3, -4, 1}, b = far_place + Vec3d{3, 4, 2};
    const ClipBox section = section_between(a, b, 0.5, clouds);
    const Clip cut = section.clip(std::nullopt);
    EXPECT_NEAR(section.half[0], 5, 1e-9);
    EXPECT_NEAR(section.half[1], 0.25, 1e-12);
    const Vec3d along = normalised(Vec3d{6, 8, 0}), across{-along[1], along[0], 0};
    EXPECT_TRUE(cut.holds(a + 1e-6 * along + Vec3d{0, 0, 3.9}));
    EXPECT_FALSE(cut.holds(a - 1e-6 * along));
    EXPECT_TRUE(cut.holds(far_place + 0.249 * across));
    EXPECT_FALSE(cut.holds(far_place + 0.251 * across));
    EXPECT_THROW(section_between(a, a + Vec3d{0, 0, 7}, 0.5, clouds), Error);

    const Clip between = box_between(a, b, clouds).clip(std::nullopt);
    EXPECT_TRUE(between.holds(far_place + Vec3d{2.9, -3.9, 4.9}));
    EXPECT_FALSE(between.holds(far_place + Vec3d{3.1, 0, 0}));
}

TEST(ClipBox, BoxesAroundFlatSmallAndHugeCloudsCanBeUsed)
{
    for (const double extent : {0.0, 1e-6, 1.0, 1e9})
        for (const double place : {0.0, 1e7}) {
            const Box3d cloud{{place, place, place}, {place + extent, place + extent, place}};  // flat
            const ClipBox box = box_around(cloud);
            for (const double half : box.half) EXPECT_GT(half, 0);
            const Clip clip = box.clip(std::nullopt);
            EXPECT_TRUE(clip.holds(cloud.centre())) << extent << ' ' << place;
        }
}

TEST(ClipText, KeepsAllDigits)
{
    ClipBox box = box_at({500000.1234567891, -4800000.987654321, 1.0 / 3}, 33.3);
    box.outside = true;
    box.enabled = false;
    EXPECT_TRUE(same(clip_box_of(text_of(box)), box));
}

TEST(ClipText, RefusesWhatIsNoBox)
{
    const QString good = text_of(box_at({1, 2, 3}));
    const auto changed = [&](const char* from, const char* to) {
        QString text = good;
        text.replace(from, to);
        EXPECT_NE(text, good) << from;
        return text;
    };
    for (const QString& text :
         {QString(), QString("{}"), QString("[1,2]"), good.left(good.size() / 2),
          changed("\"half\":[1,", "\"half\":[0,"), changed("\"half\":[1,", "\"half\":["),
          changed("[1,0,0]", "[1,0.1,0]"), changed("[1,0,0]", "[2,0,0]"), changed("\"outside\":false", "\"outside\":3"),
          changed("\"centre\":[1,", "\"centre\":[\"a\",")}) {
        try {
            clip_box_of(text);
            FAIL() << text.toStdString();
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::bad_format);
            EXPECT_NE(std::string(error.what()).find("PointCloudClipBox"), std::string::npos);
        }
    }
}

TEST(ClipHistory, ChangesAreTakenBackAndRepeated)
{
    MetDocument document;
    ClipHistory& history = scene_of(document).part<ClipHistory>();
    SceneState& state = scene_of(document).part<SceneState>();
    const ClipBox a = box_at({1, 0, 0}), b = box_at({2, 0, 0}), c = box_at({3, 0, 0});
    EXPECT_FALSE(history.can_undo());
    history.keep(a);
    history.show(b);  // while it is dragged
    history.show(c);
    history.keep(c);
    state.set_clip(b);  // another tool sets it
    history.keep(b);    // the same: no step
    history.undo();
    EXPECT_TRUE(same(state.clip(), c));
    history.undo();
    EXPECT_TRUE(same(state.clip(), a));
    history.undo();
    EXPECT_FALSE(state.clip());
    EXPECT_FALSE(history.can_undo());
    history.undo();
    history.redo();
    EXPECT_TRUE(same(state.clip(), a));
    history.keep(std::nullopt);  // a new way: what was undone is gone
    EXPECT_FALSE(history.can_redo());
    history.undo();
    EXPECT_TRUE(same(state.clip(), a));
}

TEST(ClipText, ProjectsKeepTheBox)
{
    keep_clip_boxes_in_projects();
    keep_clip_boxes_in_projects();  // once
    int found = 0;
    for (const ProjectPart& part : project_parts()) {
        if (part.name != "PointCloudClipBox") continue;
        ++found;
        MetDocument before, after;
        EXPECT_TRUE(part.text(scene_of(before)).isEmpty());
        const ClipBox box = box_at(far_place, 12);
        scene_of(before).part<SceneState>().set_clip(box);
        const ClipHistory& history = scene_of(after).part<ClipHistory>();
        part.take(scene_of(after), part.text(scene_of(before)));
        EXPECT_TRUE(same(scene_of(after).part<SceneState>().clip(), box));
        EXPECT_FALSE(history.can_undo()) << "undo would take the opening of a project back";
        EXPECT_THROW(part.take(scene_of(after), "?"), Error);
        EXPECT_TRUE(same(scene_of(after).part<SceneState>().clip(), box));
    }
    EXPECT_EQ(found, 1);
}

}  // namespace
