// Brings MeshLab back to its beginning after a test, so that the next test finds what it would find in a new MeshLab.
#pragma once

#include "plugin/meshlab/meshlab.h"
#include "tests/e2e/driver/driver.h"

#include <QMap>
#include <QVariant>

class StartOver {
public:
    // Whether MeshLab shows its first, empty view, as large as the screen.
    static bool has_begun(const TestDriver& driver);

    // Remembers MeshLab as it is now.
    explicit StartOver(const TestDriver& driver);

    // The command start-over: closes all documents and panels, restores the settings, and opens an empty document.
    Done run(TestDriver& driver);

private:
    void restore(TestDriver& driver);

    RichParameterList parameters_;
    QMap<QString, QVariant> settings_;  // as stored for the next start
    bool restored_ = false;
};
