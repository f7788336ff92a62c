#include "pcm/fit/pcl/pcl_module.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <limits>
#include <memory>

#include <pcl/console/print.h>
#include <pcl/point_types.h>
#include <pcl/sample_consensus/mlesac.h>
#include <pcl/sample_consensus/msac.h>
#include <pcl/sample_consensus/prosac.h>
#include <pcl/sample_consensus/ransac.h>
#include <pcl/sample_consensus/rmsac.h>
#include <pcl/sample_consensus/rransac.h>
#include <pcl/sample_consensus/sac_model_cone.h>
#include <pcl/sample_consensus/sac_model_cylinder.h>
#include <pcl/sample_consensus/sac_model_plane.h>
#include <pcl/sample_consensus/sac_model_sphere.h>

namespace pcm {
namespace {

using Point = pcl::PointXYZ;
using Model = pcl::SampleConsensusModel<Point>;
using Search = pcl::SampleConsensus<Point>;

// Counts the samples and ends the search. PCL's RRANSAC and RMSAC skip their own check of the number of samples
// whenever a sample fails the pretest, and so never end by themselves when all do.
struct Samples {
    const PclRequest& request;
    std::uint64_t drawn = 0;
    bool end() { return drawn >= request.iterations || (request.stop && request.stop(request.context)); }
};

template <class Base>
class BoundedModel final : public Base {
public:
    template <class Cloud>
    BoundedModel(const Cloud& cloud, Samples& samples) : Base(cloud), samples_(samples)
    {
        this->rng_alg_.seed(samples.request.seed);
        this->setRadiusLimits(samples.request.least_radius, samples.request.largest_radius);
    }

    void getSamples(int& iterations, pcl::Indices& sample) override
    {
        if (!samples_.end()) {
            Base::getSamples(iterations, sample);
            if (!sample.empty()) {
                ++samples_.drawn;
                last_ = sample;
                return;
            }
        }
        // All estimators end without a sample, but PROSAC, which may take the last index of an empty one: it ends by
        // the number of iterations.
        sample.clear();
        if (samples_.request.estimator != Estimator::prosac) return;
        iterations = std::numeric_limits<int>::max() - 1;
        sample = last_;
        if (sample.empty()) sample.assign(this->getSampleSize(), 0);
    }

    bool computeModelCoefficients(const pcl::Indices& sample, Eigen::VectorXf& coefficients) const override
    {
        return sample.size() == this->getSampleSize() && Base::computeModelCoefficients(sample, coefficients) &&
               coefficients.allFinite() && this->isModelValid(coefficients);
    }

private:
    Samples& samples_;
    pcl::Indices last_;
};

// PCL's threshold of MLESAC is a share of the median distance of points from their median: here it is a distance, two
// standard deviations as PCL counts them.
class Mlesac final : public pcl::MaximumLikelihoodSampleConsensus<Point> {
public:
    Mlesac(const Model::Ptr& model, double threshold) : MaximumLikelihoodSampleConsensus(model, threshold)
    {
        const double spread = computeMedianAbsoluteDeviation(model->getInputCloud(), model->getIndices(), 1);
        setDistanceThreshold(spread > 0 ? threshold / (2 * spread) : threshold);
    }
};

template <class Base>
class Pretested final : public Base {
public:
    Pretested(const Model::Ptr& model, const PclRequest& request) : Base(model, request.threshold)
    {
        this->setFractionNrPretest(request.pretest);
    }
};

std::unique_ptr<Search> make_search(const Model::Ptr& model, const PclRequest& request)
{
    switch (request.estimator) {
        case Estimator::ransac:
            return std::make_unique<pcl::RandomSampleConsensus<Point>>(model, request.threshold);
        case Estimator::msac:
            return std::make_unique<pcl::MEstimatorSampleConsensus<Point>>(model, request.threshold);
        case Estimator::mlesac:
            return std::make_unique<Mlesac>(model, request.threshold);
        case Estimator::prosac:
            return std::make_unique<pcl::ProgressiveSampleConsensus<Point>>(model, request.threshold);
        case Estimator::rransac:
            return std::make_unique<Pretested<pcl::RandomizedRandomSampleConsensus<Point>>>(model, request);
        case Estimator::rmsac:
            break;
    }
    return std::make_unique<Pretested<pcl::RandomizedMEstimatorSampleConsensus<Point>>>(model, request);
}

template <class Base, class Cloud>
Model::Ptr make_with_normals(const Cloud& cloud, const PclRequest& request, Samples& samples)
{
    auto normals = pcl::make_shared<pcl::PointCloud<pcl::Normal>>();
    normals->reserve(request.points);
    for (const float* n = request.normals; n != request.normals + 3 * request.points; n += 3)
        normals->push_back(pcl::Normal(n[0], n[1], n[2]));
    auto model = pcl::make_shared<BoundedModel<Base>>(cloud, samples);
    model->setInputNormals(normals);
    return model;
}

Model::Ptr make_model(const PclRequest& request, Samples& samples)
{
    auto cloud = pcl::make_shared<pcl::PointCloud<Point>>();
    cloud->reserve(request.points);
    for (const float* p = request.xyz; p != request.xyz + 3 * request.points; p += 3)
        cloud->push_back(Point(p[0], p[1], p[2]));
    const pcl::PointCloud<Point>::ConstPtr points = cloud;
    switch (request.model) {
        case PclModel::plane:
            return pcl::make_shared<BoundedModel<pcl::SampleConsensusModelPlane<Point>>>(points, samples);
        case PclModel::sphere:
            return pcl::make_shared<BoundedModel<pcl::SampleConsensusModelSphere<Point>>>(points, samples);
        case PclModel::cylinder:
            return make_with_normals<pcl::SampleConsensusModelCylinder<Point, pcl::Normal>>(points, request, samples);
        case PclModel::cone:
            break;
    }
    return make_with_normals<pcl::SampleConsensusModelCone<Point, pcl::Normal>>(points, request, samples);
}

bool fit(const PclRequest& request, PclAnswer& answer, char* message)
try {
    message[0] = 0;
    Samples samples{request};
    const Model::Ptr model = make_model(request, samples);
    if (request.points < model->getSampleSize()) return false;  // PROSAC would read beyond them
    const std::unique_ptr<Search> search = make_search(model, request);
    search->setMaxIterations(static_cast<int>(std::min<std::uint32_t>(request.iterations, 1000000000)));
    search->setProbability(request.probability);
    const bool found = search->computeModel();
    answer.samples = samples.drawn;
    if (!found) return false;
    Eigen::VectorXf coefficients;
    search->getModelCoefficients(coefficients);
    if (request.optimise) {
        pcl::Indices inliers;
        search->getInliers(inliers);
        Eigen::VectorXf better = coefficients;
        if (inliers.size() > model->getSampleSize()) model->optimizeModelCoefficients(inliers, coefficients, better);
        if (better.allFinite()) coefficients = better;
    }
    for (Eigen::Index i = 0; i < std::min<Eigen::Index>(7, coefficients.size()); ++i)
        answer.coefficients[i] = coefficients[i];
    return true;
} catch (const std::exception& failure) {
    std::strncpy(message, failure.what(), pcl_message_bytes - 1);
    message[pcl_message_bytes - 1] = 0;
    return false;
}

}  // namespace
}  // namespace pcm

extern "C" __attribute__((visibility("default"))) const void* pcm_pcl_functions()
{
    // PCL prints what it returns as false, too.
    pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
    static constexpr pcm::PclFunctions functions{pcm::pcl_module_version, pcm::fit};
    return &functions;
}
