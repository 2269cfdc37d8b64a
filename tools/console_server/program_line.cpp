// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/console_server/program_line.hpp"

#include <boost/asio/buffer.hpp>

namespace capstan::tools {

using boost::system::error_code;

ProgramLine::ProgramLine(boost::asio::io_context& io, int descriptor, std::function<void(std::string_view)> heard)
    : line_(io), heard_(std::move(heard)) {
  line_.assign(descriptor);
  line_.non_blocking(true);
}

void ProgramLine::read() {
  line_.async_read_some(boost::asio::buffer(in_),
                        [self = shared_from_this()](const error_code& error, std::size_t count) {
                          if (!self->heard_) {
                            return;
                          }
                          self->heard_({self->in_.data(), error ? 0 : count});
                          if (!error) {
                            self->read();
                          }
                        });
}

void ProgramLine::send(std::string_view bytes) {
  if (line_.is_open() && backlog_.has_room_for(bytes.size())) {
    backlog_.add(bytes.size(), Backlog::Clock::now());
    waiting_ += bytes;
    if (going_.empty()) {
      write();
    }
  }
}

void ProgramLine::write() {
  going_.swap(waiting_);
  gone_ = 0;
  if (!going_.empty()) {
    write_on();
  }
}

void ProgramLine::write_on() {
  line_.async_write_some(boost::asio::buffer(going_) + gone_,
                         [self = shared_from_this()](const error_code& error, std::size_t count) {
                           if (error) {
                             return;
                           }
                           self->backlog_.take(count, Backlog::Clock::now());
                           self->gone_ += count;
                           if (self->gone_ < self->going_.size()) {
                             self->write_on();
                           } else {
                             self->going_.clear();
                             self->write();
                           }
                         });
}

void ProgramLine::close() {
  heard_ = nullptr;
  error_code ignored;
  line_.close(ignored);
}

}  // namespace capstan::tools
