// A long operation inside MeshLab, such as building a tree.
//
// MeshLab runs filters and file formats in the GUI thread, and its progress callback processes events: a user could
// start the operation a second time, delete the layer that it fills, or close the document under it. While an Operation
// lives, keys, clicks and closing are held off, save for Esc, which cancels (MeshLab itself has no cancel).
#pragma once

#include "pcm/system/progress.h"

#include <common/interfaces.h>

#include <QElapsedTimer>
#include <QObject>

namespace pcm::host {

class Operation : public QObject {
    Q_OBJECT

public:
    // `callback` may be null. Throws Error(invalid_argument) while there is another operation.
    explicit Operation(vcg::CallBackPos* callback);
    ~Operation() override;

    // For the core's `progress` arguments; valid while this lives.
    ProgressFunction progress();
    // Throws what the constructor throws; for what must not be touched while another operation fills it.
    static void refuse_second();

protected:
    bool eventFilter(QObject* receiver, QEvent* event) override;

private:
    bool report(const ProgressUpdate& update);

    vcg::CallBackPos* callback_;
    QElapsedTimer since_events_;
    bool cancelled_ = false;
};

}  // namespace pcm::host
