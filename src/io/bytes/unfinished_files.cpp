#include "io/bytes/unfinished_files.h"

#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <new>

namespace crumple::io {

/// Entry for one file. The owner and remove_unfinished_files() may both try to exchange `name` for null; only the one
/// that succeeds may remove the file. If that is not the owner, the name is never freed and the slot never reused: a
/// signal handler must not use the heap, and the owner cannot know when the handler is done with the name.
struct UnfinishedFile::Slot {
    std::atomic<bool> taken{true};
    std::atomic<char*> name{nullptr};
    char* given = nullptr;
    Slot* next = nullptr;
};

std::atomic<UnfinishedFile::Slot*> UnfinishedFile::slots_{nullptr};

namespace {

struct AtExit {
    ~AtExit() { remove_unfinished_files(); }
} at_exit;

}  // namespace

void remove_unfinished_files() noexcept {
    for (auto* slot = UnfinishedFile::slots_.load(); slot; slot = slot->next) {
        if (const char* const name = slot->name.exchange(nullptr)) ::unlink(name);
    }
}

void UnfinishedFile::begin(const std::filesystem::path& name) {
    char* const copy = ::strdup(name.c_str());
    if (!copy) throw std::bad_alloc();
    for (Slot* slot = slots_.load(); slot && !slot_; slot = slot->next) {
        if (!slot->taken.exchange(true)) slot_ = slot;
    }
    if (!slot_) {
        slot_ = new Slot;
        slot_->next = slots_.load();
        while (!slots_.compare_exchange_weak(slot_->next, slot_)) {
        }
    }
    slot_->given = copy;
    slot_->name = copy;
}

void UnfinishedFile::finish() { give_back(false); }
void UnfinishedFile::remove() { give_back(true); }

void UnfinishedFile::give_back(bool unlink) {
    if (!slot_) return;
    if (char* const name = slot_->name.exchange(nullptr)) {
        if (unlink) ::unlink(name);
        std::free(name);
        slot_->taken = false;
    }
    slot_ = nullptr;
}

}  // namespace crumple::io
