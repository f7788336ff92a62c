// What tools of MeshLab do to the sample of a tree.
#include "plugin/meshlab/sample_change.h"

#include "plugin/meshlab/layer.h"
#include "plugin/scene/open_clouds.h"
#include "tests/plugin/met_document.h"
#include "tests/plugin/scenes.h"

namespace pcm::host {
namespace {

using Kind = SampleChange::Kind;

class Samples : public testing::Test {
protected:
    void SetUp() override
    {
        layer_ = document_.addNewMesh("a", "a");
        show_tree(*layer_, open_cloud(tree_of(scene(folder_, "a.las", 80000, far_away))));
        sample_ = Registry::instance().find(*layer_)->sample;
    }

    SampleChange change() const { return find_change(*layer_, *sample_); }
    bool is_noticed() const { return state_of(*layer_, Watched::sample) != Registry::instance().find(*layer_)->state; }

    // As MeshLab's Freeze Current Matrix.
    void freeze(const Matrix44m& matrix)
    {
        for (auto& vertex : layer_->cm.vert) vertex.P() = matrix * vertex.P();
        layer_->cm.Tr.SetIdentity();
    }

    void expect_sample_is_back() const
    {
        ASSERT_EQ(static_cast<std::size_t>(layer_->cm.vn), sample_->points.size());
        for (std::size_t i = 0; i < sample_->points.size(); ++i) {
            const auto& p = sample_->points[i].position;
            ASSERT_EQ(layer_->cm.vert[i].P(), Point3m(p[0], p[1], p[2]));
        }
        EXPECT_FALSE(is_noticed());
    }

    const test::TemporaryFolder folder_;
    MetDocument document_;
    MeshModel* layer_ = nullptr;
    std::shared_ptr<const Proxy> sample_;
};

TEST_F(Samples, AreUnchangedAtFirstAndBySelectionsAndMatrices)
{
    EXPECT_FALSE(is_noticed());
    EXPECT_EQ(change().kind, Kind::none);
    layer_->cm.vert[5].SetS();
    layer_->cm.Tr.SetTranslate(5, 6, 7);
    EXPECT_FALSE(is_noticed());
    EXPECT_EQ(sample_warning(*layer_), "");
}

TEST_F(Samples, AFrozenMatrixIsTheLayersMatrixAgain)
{
    Matrix44m turned, scaled;
    turned.SetRotateDeg(33, Point3m(0.2f, 0.3f, 1));
    scaled.SetScale(2, 2, -0.5f);
    Matrix44m shifted;
    shifted.SetTranslate(100, -20, 3.5f);
    Matrix44m together = shifted;
    together = together * turned;
    together = together * scaled;
    for (const Matrix44m& matrix : {shifted, turned, scaled, together}) {
        freeze(matrix);
        EXPECT_TRUE(is_noticed());
        const SampleChange found = change();
        ASSERT_EQ(found.kind, Kind::moved) << found.text;
        unfreeze(*layer_, *sample_, found);
        expect_sample_is_back();
        for (int r = 0; r < 4; ++r)
            for (int c = 0; c < 4; ++c)
                EXPECT_NEAR(layer_->cm.Tr[r][c], matrix[r][c], 1e-5 * (1 + std::fabs(matrix[r][c])));
        layer_->cm.Tr.SetIdentity();
    }
}

TEST_F(Samples, AMoveDoesNotTurn)
{
    Matrix44m shifted;
    shifted.SetTranslate(12.5f, 0, -3);
    freeze(shifted);
    unfreeze(*layer_, *sample_, change());
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) EXPECT_EQ(layer_->cm.Tr[r][c], r == c ? 1 : 0);
}

TEST_F(Samples, AFrozenMatrixComesBeforeTheLayersOwn)
{
    Matrix44m turned, shifted;
    turned.SetRotateDeg(90, Point3m(0, 0, 1));
    shifted.SetTranslate(10, 0, 0);
    freeze(turned);
    layer_->cm.Tr = shifted;
    unfreeze(*layer_, *sample_, change());
    const Point3m p = layer_->cm.Tr * Point3m(1, 0, 0);
    EXPECT_NEAR(p[0], 10, 1e-5);
    EXPECT_NEAR(p[1], 1, 1e-5);
}

TEST_F(Samples, DeletedVerticesAreNamedWhetherCompactedOrNot)
{
    std::vector<std::uint32_t> expected;
    for (std::uint32_t i = 3; i < layer_->cm.vert.size(); i += 7) {
        vcg::tri::Allocator<CMeshO>::DeleteVertex(layer_->cm, layer_->cm.vert[i]);
        expected.push_back(i);
    }
    EXPECT_TRUE(is_noticed());
    EXPECT_EQ(change().kind, Kind::deleted);
    EXPECT_EQ(change().deleted, expected);
    vcg::tri::Allocator<CMeshO>::CompactEveryVector(layer_->cm);
    EXPECT_EQ(change().deleted, expected);
    EXPECT_NE(sample_warning(*layer_).find("80,000 points of the cloud are unchanged"), std::string::npos);
    restore_sample(*layer_, *sample_);
    expect_sample_is_back();
}

TEST_F(Samples, OtherChangesAreNamedToo)
{
    layer_->cm.vert[7].C()[0] ^= 255;
    EXPECT_TRUE(is_noticed());
    EXPECT_EQ(change().kind, Kind::other);
    EXPECT_NE(change().text.find("the colours of 1 of"), std::string::npos);
    restore_sample(*layer_, *sample_);

    layer_->cm.vert[7].P()[0] += 1;
    EXPECT_EQ(change().kind, Kind::other);
    EXPECT_NE(change().text.find("1 of"), std::string::npos);
    restore_sample(*layer_, *sample_);

    vcg::tri::Allocator<CMeshO>::AddVertices(layer_->cm, 2);
    EXPECT_EQ(change().text, "2 vertices were added");
    restore_sample(*layer_, *sample_);

    vcg::tri::Allocator<CMeshO>::AddFaces(layer_->cm, 1);
    EXPECT_TRUE(is_noticed());
    EXPECT_EQ(change().kind, Kind::other);
    restore_sample(*layer_, *sample_);
    expect_sample_is_back();
}

}  // namespace
}  // namespace pcm::host
