// A test for growth on the points around a point.
#pragma once

#include "pcm/cloud/geometry.h"

#include <memory>

namespace pcm {

class PlaceTest;

// Any number of threads.
class SurroundingsTest {
public:
    virtual ~SurroundingsTest() = default;

    // Gets points around places, then tests whether the places pass. One thread.
    class Judge {
    public:
        virtual ~Judge() = default;
        virtual void add(const Vec3d& p) = 0;
        virtual bool passes(const Vec3d& p) = 0;
    };
    virtual std::unique_ptr<Judge> judge() const = 0;

    // A judge must have got all points in the box that is this much wider on all sides than the places it is asked
    // about, for which counts() holds. More of them do not change its answers. Source units.
    virtual double margin() const = 0;
    virtual const PlaceTest& counts() const = 0;
};

}  // namespace pcm
