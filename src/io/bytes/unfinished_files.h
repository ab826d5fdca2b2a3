#pragma once

// The names of files that are being written beside their targets, so that none stays behind when the process ends
// early: by exit() while another thread writes, or by a signal whose handler calls remove_unfinished_files().

#include <atomic>
#include <filesystem>

namespace crumple::io {

/// Removes them all. Async-signal-safe. A thread that is writing one of them fails to finish it.
void remove_unfinished_files() noexcept;

/// A file that is removed unless it is finished.
class UnfinishedFile {
   public:
    UnfinishedFile() = default;
    UnfinishedFile(const UnfinishedFile&) = delete;
    UnfinishedFile& operator=(const UnfinishedFile&) = delete;
    ~UnfinishedFile() { remove(); }

    /// Call before the file is made.
    void begin(const std::filesystem::path& name);
    /// The file is renamed, or was removed: there is nothing to remove any more.
    void finish();
    void remove();

   private:
    struct Slot;
    void give_back(bool unlink);
    friend void remove_unfinished_files() noexcept;

    /// All slots there have ever been; they are used again and never freed.
    static std::atomic<Slot*> slots_;
    Slot* slot_ = nullptr;
};

}  // namespace crumple::io
