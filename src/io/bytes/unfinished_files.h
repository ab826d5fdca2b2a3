#pragma once

// Registry of temporary files that are being written, so that none stays behind when the process ends early: by exit()
// while another thread writes, or by a signal whose handler calls remove_unfinished_files().

#include <atomic>
#include <filesystem>

namespace crumple::io {

/// Removes all unfinished files. Async-signal-safe. A thread that is still writing one of them will fail to rename it.
void remove_unfinished_files() noexcept;

/// Registration of one file, which is removed unless it is finished.
class UnfinishedFile {
   public:
    UnfinishedFile() = default;
    UnfinishedFile(const UnfinishedFile&) = delete;
    UnfinishedFile& operator=(const UnfinishedFile&) = delete;
    ~UnfinishedFile() { remove(); }

    /// Registers the file. Call before creating it.
    void begin(const std::filesystem::path& name);
    /// Unregisters the file without removing it. Call once it has been renamed or removed.
    void finish();
    void remove();

   private:
    struct Slot;
    void give_back(bool unlink);
    friend void remove_unfinished_files() noexcept;

    /// List of all slots ever allocated; they are reused and never freed.
    static std::atomic<Slot*> slots_;
    Slot* slot_ = nullptr;
};

}  // namespace crumple::io
