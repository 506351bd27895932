// engine/base/large_pages.h — memory for tables that are read at random.
#pragma once
#include <sys/mman.h>

#include <cstddef>
#include <new>

namespace lensproof {

/// An allocator that asks for pages of 2 MiB where they fit: of a large table in pages of 4 KiB, nearly every read at
/// random waits for the page's address before it waits for the number. The system may decline; nothing else changes.
template <class T>
struct LargePages {
    using value_type = T;

    LargePages() = default;
    template <class U>
    explicit LargePages(const LargePages<U>& /*other*/) {}

    T* allocate(std::size_t count) {
        const std::size_t bytes = count * sizeof(T);
        if (bytes < kPage) {
            return static_cast<T*>(::operator new(bytes));
        }
        void* memory = ::operator new(bytes, std::align_val_t(kPage));
        madvise(memory, bytes, MADV_HUGEPAGE);
        return static_cast<T*>(memory);
    }
    void deallocate(T* memory, std::size_t count) {
        if (count * sizeof(T) < kPage) {
            ::operator delete(memory);
        } else {
            ::operator delete(memory, std::align_val_t(kPage));
        }
    }
    friend bool operator==(const LargePages&, const LargePages&) { return true; }

  private:
    static constexpr std::size_t kPage = std::size_t{1} << 21U;
};

}  // namespace lensproof
