#!/bin/sh
# A shell script that was dropped into algorithms/ and does not know the protocol.
echo "Hello from the shell"
sleep 600
