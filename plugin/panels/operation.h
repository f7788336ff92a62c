// A long operation inside MeshLab, such as building a tree.
//
// MeshLab runs filters, importers and exporters in the GUI thread, and its progress callback processes events: a user
// could start the operation a second time, delete the layer that it fills, or close the scene. During the lifetime
// of an Operation, keys, clicks and closing the window are ignored, except Esc, which cancels (MeshLab itself has no
// cancel). A file that grows beyond the system's limit is an error then, and does not end MeshLab. GUI thread.
#pragma once

#include "pcm/system/progress.h"

#include <QElapsedTimer>
#include <QObject>

#include <string>

namespace pcm::host {

// Percent, and what is being done; the result has no meaning.
using ProgressCallback = bool(int percent, const char* text);

class Operation : public QObject {
    Q_OBJECT

public:
    // `callback` may be null. Throws Error(invalid_argument) while another operation exists.
    explicit Operation(ProgressCallback* callback);
    ~Operation() override;

    // For the core's `progress` options; valid during the lifetime of this object.
    ProgressFunction progress();
    // Throws what the constructor throws. Called before touching anything that another operation may be filling.
    static void refuse_second();
    // Asks the user and waits for the answer: the dialog gets its keys and clicks. Not without a window.
    bool ask(QWidget* window, const std::string& question);

protected:
    bool eventFilter(QObject* receiver, QEvent* event) override;

private:
    bool report(const ProgressUpdate& update);

    void ignore_file_size_signal();

    ProgressCallback* callback_;
    bool signal_ignored_ = false;  // whether this operation ignores it
    QElapsedTimer since_events_;
    bool cancelled_ = false;
    bool asking_ = false;
};

}  // namespace pcm::host
