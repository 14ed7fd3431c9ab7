#pragma once

/// @file
/// The parallel loop and the reduction. Work is cut into blocks whose bounds depend on the size of the problem
/// alone, never on the number of threads, and sums are added in block order: results are bitwise the same for any
/// number of threads.

#include <cdem/core/error.hpp>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <type_traits>
#include <vector>

namespace cdem::core {

/// A fixed team of threads that share the blocks of a loop; the calling thread is one of them.
///
/// Workers spin for a short while before they sleep, since an explicit time step starts a loop every few hundred
/// microseconds. One thread (the default) starts no worker and costs a plain loop. A pool belongs to one caller at a
/// time: run() is not re-entrant.
class ThreadPool {
public:
  /// @param threads  1 or more; 0 means all the processors of the machine
  explicit ThreadPool(int threads = 1) {
    expect(threads >= 0 && threads <= 4096, "threads", threads, "0 (all processors) to 4096 is expected");
    if (threads == 0)
      threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    size_ = threads;
    const int processors = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    spins_ =
        threads <= processors ? 4000 : 0; // spinning threads that outnumber the processors starve each other
    for (int t = 1; t < size_; ++t)
      workers_.emplace_back([this, t] { work(t); });
  }
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;
  ~ThreadPool() {
    {
      std::lock_guard lock(mutex_);
      stop_ = true;
      epoch_.fetch_add(1, std::memory_order_release);
    }
    wake_.notify_all();
    for (auto& worker : workers_)
      worker.join();
  }

  /// Number of threads, the caller's included.
  int size() const noexcept { return size_; }

  /// Calls body(block) for every block in [0, blocks), each once. Thread t takes a contiguous share, so that a block
  /// meets the same thread (and its cache) at every call. Rethrows the first exception by thread number.
  template <class Body>
  void for_each_block(std::size_t blocks, Body&& body) {
    if (size_ == 1 || blocks <= 1) {
      for (std::size_t block = 0; block < blocks; ++block)
        body(block);
      return;
    }
    using Plain = std::remove_reference_t<Body>;
    call_ = [](void* context, std::size_t begin, std::size_t end) {
      auto& function = *static_cast<Plain*>(context);
      for (std::size_t block = begin; block < end; ++block)
        function(block);
    };
    context_ = const_cast<void*>(static_cast<const void*>(std::addressof(body)));
    blocks_ = blocks;
    errors_.assign(static_cast<std::size_t>(size_), nullptr);
    pending_.store(size_ - 1, std::memory_order_relaxed);
    {
      std::lock_guard lock(mutex_);
      epoch_.fetch_add(1, std::memory_order_release);
    }
    if (sleepers_.load(std::memory_order_acquire) > 0)
      wake_.notify_all();
    run_share(0);
    for (int spin = 0; pending_.load(std::memory_order_acquire) > 0; ++spin)
      if (spin > spins_)
        std::this_thread::yield();
    for (auto& error : errors_)
      if (error)
        std::rethrow_exception(error);
  }

private:
  void run_share(int thread) {
    const auto share = [&](int t) {
      return blocks_ * static_cast<std::size_t>(t) / static_cast<std::size_t>(size_);
    };
    try {
      call_(context_, share(thread), share(thread + 1));
    } catch (...) {
      errors_[static_cast<std::size_t>(thread)] = std::current_exception();
    }
  }

  void work(int thread) {
    std::size_t seen = 0;
    for (;;) {
      for (int spin = 0; spin < spins_ && epoch_.load(std::memory_order_acquire) == seen; ++spin)
        pause();
      if (epoch_.load(std::memory_order_acquire) == seen) {
        std::unique_lock lock(mutex_);
        sleepers_.fetch_add(1, std::memory_order_acq_rel);
        wake_.wait(lock, [&] { return epoch_.load(std::memory_order_acquire) != seen; });
        sleepers_.fetch_sub(1, std::memory_order_acq_rel);
      }
      seen = epoch_.load(std::memory_order_acquire);
      if (stop_)
        return;
      run_share(thread);
      pending_.fetch_sub(1, std::memory_order_release);
    }
  }

  static void pause() noexcept {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
  }

  int size_ = 1;
  int spins_ = 0;
  std::vector<std::thread> workers_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::atomic<std::size_t> epoch_{0};
  std::atomic<int> pending_{0};
  std::atomic<int> sleepers_{0};
  bool stop_ = false;
  void (*call_)(void*, std::size_t, std::size_t) = nullptr;
  void* context_ = nullptr;
  std::size_t blocks_ = 0;
  std::vector<std::exception_ptr> errors_;
};

/// Items of one block of parallel_for and parallel_sum.
inline constexpr std::size_t block_size = 2048;

/// Calls body(begin, end) over [0, count) in blocks of `block_size`; bodies must write to disjoint places.
template <class Body>
void parallel_for(ThreadPool& pool, std::size_t count, Body&& body) {
  pool.for_each_block((count + block_size - 1) / block_size, [&](std::size_t block) {
    body(block * block_size, std::min(count, (block + 1) * block_size));
  });
}

/// Sum of body(begin, end) over the blocks of [0, count), added in block order.
///
/// @return      the same bits for any number of threads
/// @complexity  one allocation of count/block_size partial sums
template <class Value, class Body>
Value parallel_sum(ThreadPool& pool, std::size_t count, Value zero, Body&& body) {
  const std::size_t blocks = (count + block_size - 1) / block_size;
  std::vector<Value> partial(blocks, zero);
  pool.for_each_block(blocks, [&](std::size_t block) {
    partial[block] = body(block * block_size, std::min(count, (block + 1) * block_size));
  });
  Value total = zero;
  for (const Value& value : partial)
    total += value;
  return total;
}

} // namespace cdem::core
