# What can be done here? `make` lists it.
SHELL := bash
# A shell started before rustup was installed does not find cargo yet.
export PATH := $(PATH):$(HOME)/.cargo/bin
TARGET := $(or $(CARGO_TARGET_DIR),target)
FUZZ_SECONDS := 60
export INPUT
# Where there is no desktop, Mesa's Vulkan layers complain about its absence.
export XDG_RUNTIME_DIR ?= /tmp

.PHONY: help setup build web demo samples pictures test check fuzz clean

help: ## list these targets
	@sed -nE 's/^([a-z]+):[^#]*## (.*)/make \1|\2/p' Makefile | \
		while IFS='|' read -r name text; do printf '%-14s %s\n' "$$name" "$$text"; done

setup: ## install what is missing to build and test
	@scripts/install.sh

build: setup ## build the page, and the release program that carries it
	@cargo xtask web || echo "build: the program will carry no pages: see above" >&2
	cargo build --release

web: setup ## build the page into web/dist and say how large it is
	cargo xtask web

demo: build ## show a clip, a sphere, a mesh and panels in demo/ (INPUT=file for your own)
	@input=(); \
	if [ -n "$$INPUT" ]; then input=(--input "$$INPUT"); \
	else scripts/fetch-sample.sh "$(TARGET)/sample"; \
		case $$? in \
			0) input=(--clip "$(TARGET)/sample/bigbuckbunny.mp4") ;; \
			3) echo "demo: using a generated clip instead" >&2 ;; \
			*) exit 1 ;; \
		esac; \
	fi; \
	"$(TARGET)/release/foveal" demo --out demo "$${input[@]}"

samples: ## fetch two scanned meshes into samples/, to try scenes on
	@scripts/fetch-scenes.sh samples

pictures: build ## make every picture of the documents again, in docs/pictures
	scripts/pictures.sh "$(TARGET)/release/foveal" "$(TARGET)/pictures"

test: setup ## check everything, as CI does
	cargo xtask ci

check: ## check what differs from the last commit, in a minute or so
	cargo xtask check

fuzz: ## throw random bytes at each parser for a minute (FUZZ_SECONDS=N)
	@cargo +nightly fuzz --version >/dev/null 2>&1 || { \
		echo "fuzz: needs nightly Rust and cargo-fuzz:" >&2; \
		echo "  rustup toolchain install nightly && cargo install cargo-fuzz" >&2; exit 1; }
	@for name in $$(cargo +nightly fuzz list); do \
		echo "fuzz: $$name, $(FUZZ_SECONDS) s"; \
		cargo +nightly fuzz run "$$name" -- -max_total_time=$(FUZZ_SECONDS) || exit 1; \
	done

clean: ## remove what was built and the demo's output
	cargo clean
	rm -rf demo fuzz/target web/dist web/pkg web/node_modules
